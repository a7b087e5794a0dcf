//! The records in a chunk, unpacked and checked against its check sum before the first of them is given out.

use ::mcap::records::op;
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// The longest chunk, packed or unpacked, and the longest record, bytes. Recorders close a chunk at a few million.
pub(super) const LONGEST: u64 = 128 << 20;
/// Bytes given to the library at once: it makes room for them, whatever is announced.
const STEP: usize = 1 << 20;

/// Gives every record of a chunk to `take`, until it says no; what is wrong with the chunk.
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
