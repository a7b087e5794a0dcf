//! Unpacks the records in a chunk, after its check sum has been verified.

use ::mcap::parse_record;
use ::mcap::records::{Record, op};
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

/// The longest chunk, packed or unpacked, and the longest record that are read, bytes. Memory holds a chunk twice and
/// its unpacked content once. Recorders close a chunk at a few million bytes.
pub(super) const LONGEST: u64 = 48 << 20;
/// Number of bytes given to the library at once: it allocates this much, whatever length is announced.
const STEP: usize = 1 << 20;

/// Gives every record of a chunk to `take`, until that returns false. The error says what is wrong with the chunk.
pub(super) fn each_record(chunk: &[u8], mut take: impl FnMut(u8, &[u8]) -> bool) -> Result<(), String> {
    // The library (0.26.0) does not check whether records that are not packed end with the chunk, and its count
    // underflows.
    if let Ok(Record::Chunk { header, data }) = parse_record(op::CHUNK, chunk)
        && header.compression.is_empty()
        && !is_filled(&data)
    {
        return Err("its records do not end where it ends".to_owned());
    }
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
