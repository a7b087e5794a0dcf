//! Makes a profile for a log whose fields are named like channels, as the headers of a table are: `air.tas_kt`.

use crate::align::Hold;
use crate::log::survey::Survey;
use crate::profile::{ChannelProfile, FieldName, Profile, Source, Transform};
use crate::record::Quantity;
use crate::table::header::{self, Meaning};

/// The profile with every field whose name, or the last part of its path, is that of a channel. The topic with the most
/// samples among them gives the times. A field without a unit is taken as SI, which its note says.
pub(super) fn profile(survey: &Survey) -> Profile {
    let mut channels: Vec<ChannelProfile> = Vec::new();
    let mut bases: Vec<(bool, usize, &str)> = Vec::new();
    for topic in &survey.topics {
        let mut used = false;
        for field in &topic.fields {
            let name = field.name.rsplit('.').next().unwrap_or_default();
            let Ok(Meaning::Known { spec, unit }) = header::interpret(name, field.unit.as_deref()) else { continue };
            if spec.name == "time" {
                continue;
            }
            used = true;
            let assumed = unit.is_none() && spec.quantity != Quantity::Number;
            let si = spec.quantity.si_unit();
            let source = Source {
                field: FieldName {
                    topic: topic.name.clone(),
                    instance: Some(topic.instance),
                    field: field.name.clone(),
                },
                unit: Some(unit.map_or(si, |unit| unit.symbol).to_owned()),
                scale: 1.0,
                transform: Transform::None,
                factor: None,
                note: assumed
                    .then(|| format!("no unit is written; taken as {si} (SI): write it into the name or map it")),
            };
            match channels.iter_mut().find(|channel| channel.channel == spec.name) {
                Some(channel) => channel.sources.push(source),
                None => {
                    let channel = spec.name.to_owned();
                    channels.push(ChannelProfile { channel, hold: Hold::Sampled, sources: vec![source] });
                }
            }
        }
        bases.push((used, topic.samples, &topic.name));
    }
    bases.sort_by(|a, b| b.cmp(a));
    let time_base = bases.into_iter().map(|(.., name)| name.to_owned()).collect();
    Profile { name: "names of the fields".into(), time_base, surfaces: None, mixed: Vec::new(), channels }
}
