//! The settings of a live estimation, from the command line or from a recording.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_live::mavlink::MavlinkOptions;
use phugoid_live::receiver::ReceiverOptions;
use phugoid_live::recording::{Header, Reader};

use crate::failure::Failure;

/// Model, estimation options and receiver options of a live estimation.
pub(super) struct Flight {
    pub(super) model: ModelFile,
    pub(super) text: String,
    pub(super) options: EstimateOptions,
    pub(super) receiver: ReceiverOptions,
}

impl Flight {
    /// From the header of a recording, or from a header that was made from the command line.
    pub(super) fn of(header: &Header) -> Result<Self, Failure> {
        let model = ModelFile::parse(&header.model_name, &header.model_text).map_err(Failure::input)?;
        let method = header.method.as_deref().map(str::parse::<Method>).transpose().map_err(Failure::input)?;
        let mavlink = MavlinkOptions {
            reorder_ns: header.reorder_ns,
            system: header.system,
            base: header.base.clone(),
            ..MavlinkOptions::default()
        };
        let sender = header.sender.as_deref().map(str::parse).transpose().map_err(Failure::input)?;
        Ok(Self {
            options: EstimateOptions {
                method,
                change_detection: header.change_detection,
                ..EstimateOptions::default()
            },
            receiver: ReceiverOptions { columns: model.columns(), mavlink, sender },
            text: header.model_text.clone(),
            model,
        })
    }
}

/// Opens a recording of `phugoid live`; none if the file is something else.
pub(super) fn recording(path: &Path) -> Result<Option<Reader>, Failure> {
    let mut start = [0; 4];
    let read = File::open(path).and_then(|file| file.take(4).read(&mut start));
    let read = read.map_err(|error| Failure::input(format!("cannot read `{}`: {error}", path.display())))?;
    match Reader::is_recording(start.get(..read).unwrap_or_default()) {
        true => Reader::open(path).map(Some).map_err(Failure::input),
        false => Ok(None),
    }
}
