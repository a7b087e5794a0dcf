//! The bytes of one sender: whether they are MAVLink or text, and the frames or rows in them.

use phugoid_flight_data::csv::CsvOptions;

use crate::mavlink::frame::{self, Found, Frame};
use crate::text::{self, Lines, Row, Rows};

/// Bytes that are kept while the payload is not known; beyond this the older half is discarded.
const UNKNOWN_BYTES: usize = 8 * 1024;

/// What was found in a stream.
pub(super) enum Piece<'a> {
    /// The payload has been recognised.
    Payload(Payload),
    /// The columns of a text stream have been recognised: notes for people about them.
    Columns(Vec<String>),
    /// A row of text: its time, the channels of its columns, and their values in SI.
    Row { time_s: f64, names: &'a [String], values: &'a [f64] },
    /// A MAVLink frame whose checksum is right, or whose message is unknown.
    Frame(Frame<'a>),
    /// A known MAVLink message with a wrong checksum.
    BadChecksum,
    /// This many bytes that belong to no frame and no line.
    Garbage(usize),
    /// A row or bytes that were left out, and why.
    Refused(String),
}

/// What a sender gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Payload {
    /// MAVLink 1 or 2.
    Mavlink,
    /// CSV or JSON lines.
    Text,
}

impl Payload {
    /// The payload in words, for an event.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Mavlink => "MAVLink",
            Self::Text => "text, one sample per line",
        }
    }
}

/// The stream of one sender.
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

    /// Takes bytes. `ends` is true if a line ends with the last of them, as in a datagram.
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

    /// Looks for the first known frame whose checksum is right, or for the first line that can begin a text stream.
    fn recognise(&mut self, ends: bool, csv: &CsvOptions, out: &mut dyn FnMut(Piece<'_>)) {
        let mut at = 0;
        while let Some(rest) = self.buffer.get(at..) {
            match frame::next(rest) {
                Found::Frame(frame, _) if frame.known => {
                    self.form = Form::Mavlink;
                    out(Piece::Payload(Payload::Mavlink));
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
            match text::can_begin(line, csv) {
                Ok(()) => {
                    out(Piece::Garbage(start));
                    self.buffer.drain(..start);
                    let rows = Box::new(Rows::new(&self.peer, csv));
                    self.form = Form::Text { lines: Lines::default(), rows, names: Vec::new() };
                    out(Piece::Payload(Payload::Text));
                    return;
                }
                // The first line is the header where one is sent; the rows below it then fail for want of one.
                Err(why) => reason = reason.or(why),
            }
            start += end + 1;
        }
        // Binary data may contain bytes that look like line ends, so they are kept until the longest frame would have
        // been complete.
        let binary = self.buffer.iter().any(|byte| !byte.is_ascii_graphic() && !byte.is_ascii_whitespace());
        let discarded = match binary {
            true if self.buffer.len() > UNKNOWN_BYTES => self.buffer.len() / 2,
            true => 0,
            false if start < UNKNOWN_BYTES && self.buffer.len() - start.min(self.buffer.len()) > UNKNOWN_BYTES => {
                self.buffer.len()
            }
            false => start.min(self.buffer.len()),
        };
        if discarded > 0 {
            self.buffer.drain(..discarded);
            out(Piece::Garbage(discarded));
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
        if let Row::Columns(notes) = taken {
            *names = rows.columns().map(|columns| columns.channels().map(str::to_owned).collect()).unwrap_or_default();
            out(Piece::Columns(notes));
            taken = if rows.columns_come_with_a_sample() { rows.take(&line, row) } else { Row::Nothing };
        }
        match taken {
            Row::Sample(time_s) => out(Piece::Row { time_s, names, values: row }),
            Row::Nothing | Row::Columns(_) => {}
            Row::Refused(reason) => out(Piece::Refused(reason)),
        }
    }
}
