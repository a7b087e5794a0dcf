//! Unpacks the records in a chunk, after its check sum has been verified.

use ::mcap::records::op;
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::content::Content;

/// The longest chunk, packed or unpacked, and the longest record that are read, bytes. Memory holds a chunk twice and
/// its unpacked content once. Recorders close a chunk at a few million bytes.
pub(super) const LONGEST: u64 = 48 << 20;
/// Number of bytes given to the library at once: it allocates this much, whatever length is announced.
const STEP: usize = 1 << 20;

/// Checks the lengths in the head of a chunk, because the library (0.26.0) allocates what they say. Returns the number
/// of bytes that unpacking takes besides the chunk itself.
pub(super) fn check(chunk: &[u8]) -> Result<u64, String> {
    let Some(head) = Content(chunk).chunk() else {
        return Err("its lengths do not fit into it".to_owned());
    };
    if head.unpacked > LONGEST {
        return Err(format!("{} bytes when unpacked, more than the {LONGEST} that are read", head.unpacked));
    }
    // Of records that are not packed the library does not check whether they end with the chunk, and its count
    // underflows.
    if head.compression.is_empty() && !is_filled(head.records) {
        return Err("its records do not end where it ends".to_owned());
    }
    Ok(chunk.len() as u64 + head.unpacked)
}

/// Gives every record of a chunk that was checked to `take`, until that returns false. The error says what is wrong
/// with the chunk.
pub(super) fn each_record(chunk: &[u8], mut take: impl FnMut(u8, &[u8]) -> bool) -> Result<(), String> {
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(LONGEST as usize);
    let mut reader = LinearReader::new_with_options(options);
    let mut head = vec![op::CHUNK];
    head.extend((chunk.len() as u64).to_le_bytes());
    let mut rest = chunk;
    let mut head = head.as_slice();
    while let Some(event) = reader.next_event() {
        match event.map_err(|error| error.to_string())? {
            LinearReadEvent::ReadRequest(wanted) => {
                let from = if head.is_empty() { &mut rest } else { &mut head };
                let (step, left) = from.split_at(wanted.clamp(1, STEP).min(from.len()));
                if let Some(room) = reader.insert(step.len()).get_mut(..step.len()) {
                    room.copy_from_slice(step);
                }
                reader.notify_read(step.len());
                *from = left;
            }
            LinearReadEvent::Record { opcode, data } => {
                if !take(opcode, data) {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}

/// True if the last of these records ends where the bytes end.
fn is_filled(mut records: &[u8]) -> bool {
    while let [_, rest @ ..] = records {
        let Some((length, rest)) = rest.split_first_chunk() else { return false };
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let Some(rest) = rest.get(length..) else { return false };
        records = rest;
    }
    true
}
