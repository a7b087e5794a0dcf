//! Numbers as both logs keep them: little endian, single precision.

/// Appends numbers of single precision.
pub(crate) fn singles(bytes: &mut Vec<u8>, values: &[f64]) {
    values.iter().for_each(|value| bytes.extend((*value as f32).to_le_bytes()));
}

/// A text in a field of a fixed length, filled with zeros.
pub(crate) fn padded(bytes: &mut Vec<u8>, text: &str, length: usize) {
    bytes.extend(text.bytes().take(length));
    bytes.extend(std::iter::repeat_n(0, length.saturating_sub(text.len())));
}
