//! What a whole record tells of its surfaces, for estimates of its parts.
//!
//! A manoeuvre by itself is often too short to tell whether surfaces were held between samples, ran straight or were stamped late:
//! the moment equation needs eight seconds or more. The recorder was the same in the whole flight, which tells more.

use phugoid_flight_data::record::Record;

use crate::core::axes::Axes;
use crate::core::error::EstimateError;
use crate::model_file::{InputHold, ModelFile};
use crate::models::lateral::LateralModel;
use crate::models::longitudinal::LongitudinalModel;
use crate::models::six::SixModel;
use crate::motion::Motion;
use crate::preparation::prepare::{Prepared, prepare};
use crate::preparation::resample::earlier;

/// The record and the model file for estimates of parts of the record: where the file leaves it open how the surfaces move between
/// samples (`input = "auto"`) and the whole record tells it for certain, the file says it, surfaces that were stamped late (or early)
/// are moved in the record by as much, and the notes of the file say so. `None` where the file says it, where the record does not
/// tell it, where a surface is slower than the record, and where the record cannot be prepared: each part is then asked by itself.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::model_file::ModelFile;
/// use phugoid_identification::parts::for_parts;
/// // The model file of the F-16 says that its surfaces are held, so that there is nothing to find.
/// assert!(for_parts(&Record::open("examples/flight.csv")?, &ModelFile::named("f16")?).is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn for_parts(record: &Record, model: &ModelFile) -> Option<(Record, ModelFile)> {
    if model.input != InputHold::Auto {
        return None;
    }
    let told = match model.axes {
        Axes::Longitudinal => Told::of(prepare::<LongitudinalModel, _, _>(record, model)),
        Axes::LateralDirectional => Told::of(prepare::<LateralModel, _, _>(record, model)),
        Axes::All => Told::of(prepare::<SixModel, _, _>(record, model)),
    }?;
    let (mut record, mut model) = (record.clone(), model.clone());
    for (name, late_s) in &told.moved_s {
        for channel in record.channels.iter_mut().filter(|channel| channel.name == *name) {
            channel.values = earlier(&record.time, &channel.values, *late_s);
        }
    }
    model.input = told.hold;
    model.notes.extend(told.notes.iter().map(|note| format!("by the whole record, {note}")));
    Some((record, model))
}

/// What a record tells for certain.
struct Told {
    hold: InputHold,
    moved_s: Vec<(String, f64)>,
    notes: Vec<String>,
}

impl Told {
    fn of<M: Motion<N, R>, const N: usize, const R: usize>(
        prepared: Result<Prepared<M, N, R>, EstimateError>,
    ) -> Option<Self> {
        let Prepared { hold, moved_s, notes, surface_times, surface_time_std_s, slow_surfaces, .. } = prepared.ok()?;
        let is_seen = surface_times.is_some_and(|times| !times.is_empty());
        let is_certain = is_seen && surface_time_std_s == 0.0 && slow_surfaces.is_empty();
        let notes = notes.into_iter().filter(|note| note.starts_with("`input`")).collect();
        is_certain.then_some(Self { hold, moved_s, notes })
    }
}
