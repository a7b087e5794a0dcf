//! One peer's bytes: which payload they are, and its pieces.

use phugoid_flight_data::csv::CsvOptions;

use crate::mavlink::frame::{self, Found, Frame};
use crate::text::{self, Lines, Row, Rows};

/// Bytes that are looked at before something is known; beyond it the older half is given up.
const LOOKED_AT: usize = 8 * 1024;

/// What a stream consists of.
pub(super) enum Piece<'a> {
    /// It is known now what this is.
    Payload(&'static str),
    /// What the columns are.
    Columns(Vec<String>),
    /// A row of text.
    Row { time_s: f64, names: &'a [String], values: &'a [f64] },
    /// A frame of MAVLink.
    Frame(Frame<'a>),
    /// A known message whose checksum does not hold.
    BadChecksum,
    /// Bytes that belong to nothing.
    Garbage(usize),
    /// Something left out, and why.
    Refused(String),
}

pub(super) struct Stream {
    peer: String,
    form: Form,
    buffer: Vec<u8>,
}

enum Form {
    Unknown,
    Mavlink,
    Text { lines: Lines, rows: Box<Rows>, names: Vec<String> },
}

impl Stream {
    pub(super) fn new(peer: &str) -> Self {
        Self { peer: peer.to_owned(), form: Form::Unknown, buffer: Vec::new() }
    }

    pub(super) fn peer(&self) -> &str {
        &self.peer
    }

    /// Takes bytes; `ends` where a line ends with them.
    pub(super) fn push(
        &mut self,
        bytes: &[u8],
        ends: bool,
        csv: &CsvOptions,
        row: &mut Vec<f64>,
        out: &mut dyn FnMut(Piece<'_>),
    ) {
        if let Form::Text { lines, rows, names } = &mut self.form {
            read_text(lines, rows, names, bytes, ends, row, out);
            return;
        }
        self.buffer.extend_from_slice(bytes);
        if matches!(self.form, Form::Unknown) {
            self.recognise(ends, csv, out);
            match &mut self.form {
                Form::Unknown => return,
                Form::Mavlink => {}
                Form::Text { lines, rows, names } => {
                    let first = std::mem::take(&mut self.buffer);
                    read_text(lines, rows, names, &first, ends, row, out);
                    return;
                }
            }
        }
        read_frames(&mut self.buffer, out);
    }

    /// Finds out what this is: the first frame whose checksum holds, or the first line that begins a table.
    fn recognise(&mut self, ends: bool, csv: &CsvOptions, out: &mut dyn FnMut(Piece<'_>)) {
        let mut at = 0;
        while let Some(rest) = self.buffer.get(at..) {
            match frame::next(rest) {
                Found::Frame(frame, _) if frame.known => {
                    self.form = Form::Mavlink;
                    out(Piece::Payload("MAVLink"));
                    return;
                }
                Found::Frame(..) | Found::BadChecksum(_) => at += 1,
                Found::Garbage(bytes) => at += bytes,
                Found::Incomplete if rest.len() > 1 => at += 1,
                Found::Incomplete => break,
            }
        }
        let mut start = 0;
        let mut reason = None;
        let ending = |byte: &u8| [b'\n', b'\r'].contains(byte);
        while let Some(rest) = self.buffer.get(start..).filter(|rest| !rest.is_empty()) {
            let Some(end) = rest.iter().position(ending).or(ends.then_some(rest.len())) else { break };
            let line = rest.get(..end).unwrap_or_default();
            match text::begins(line, csv) {
                Ok(()) => {
                    out(Piece::Garbage(start));
                    self.buffer.drain(..start);
                    let rows = Box::new(Rows::new(&self.peer, csv));
                    self.form = Form::Text { lines: Lines::default(), rows, names: Vec::new() };
                    out(Piece::Payload("text, one sample per line"));
                    return;
                }
                Err(why) => reason = why.or(reason),
            }
            start += end + 1;
        }
        // Binary data may contain line ends: they are kept until a frame could have been found.
        let binary = self.buffer.iter().any(|byte| !byte.is_ascii_graphic() && !byte.is_ascii_whitespace());
        let given_up = match binary {
            true if self.buffer.len() > LOOKED_AT => self.buffer.len() / 2,
            true => 0,
            false if start < LOOKED_AT && self.buffer.len() - start.min(self.buffer.len()) > LOOKED_AT => {
                self.buffer.len()
            }
            false => start.min(self.buffer.len()),
        };
        if given_up > 0 {
            self.buffer.drain(..given_up);
            out(Piece::Garbage(given_up));
            let why = reason.unwrap_or_else(|| {
                "neither a MAVLink frame, nor JSON, nor a header line with a time (time_s,alpha_deg,...)".to_owned()
            });
            out(Piece::Refused(format!("what came is not understood: {why}")));
        }
    }
}

fn read_frames(buffer: &mut Vec<u8>, out: &mut dyn FnMut(Piece<'_>)) {
    let used = frame::split(buffer, &mut |found| match found {
        Found::Frame(frame, _) => out(Piece::Frame(frame)),
        Found::BadChecksum(_) => out(Piece::BadChecksum),
        Found::Garbage(bytes) => out(Piece::Garbage(bytes)),
        Found::Incomplete => {}
    });
    buffer.drain(..used);
}

fn read_text(
    lines: &mut Lines,
    rows: &mut Rows,
    names: &mut Vec<String>,
    bytes: &[u8],
    ends: bool,
    row: &mut Vec<f64>,
    out: &mut dyn FnMut(Piece<'_>),
) {
    let (complete, dropped) = lines.push(bytes, ends);
    if dropped > 0 {
        out(Piece::Garbage(dropped));
    }
    for line in complete {
        let mut taken = rows.take(&line, row);
        if let Row::Columns(told) = taken {
            *names = rows.columns().map(|columns| columns.channels().map(str::to_owned).collect()).unwrap_or_default();
            out(Piece::Columns(told));
            taken = if rows.again() { rows.take(&line, row) } else { Row::Nothing };
        }
        match taken {
            Row::Sample(time_s) => out(Piece::Row { time_s, names, values: row }),
            Row::Nothing | Row::Columns(_) => {}
            Row::Refused(reason) => out(Piece::Refused(reason)),
        }
    }
}
