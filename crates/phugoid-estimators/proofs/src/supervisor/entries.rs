//! Entry points into the history's ring of frames, as it is on board: 160 frames.

use super::history::History;
use crate::model::Sample;

/// Frames of one output without input: how large a frame is changes nothing of which place it has.
type Ring = History<(), u64, 1>;

/// What is read of a frame: whether it is there, its time and its output.
fn read(ring: &Ring, number: u64, out: &mut [u64; 3]) {
    *out = match ring.frame(number) {
        Some(frame) => [1, frame.time_s.to_bits(), frame.outputs[0].to_bits()],
        None => [0; 3],
    };
}

#[unsafe(no_mangle)]
pub extern "C" fn ring_frame(ring: &Ring, number: &u64, out: &mut [u64; 3]) {
    read(ring, *number, out);
}

#[unsafe(no_mangle)]
pub extern "C" fn ring_push(ring: &mut Ring, sample: &[f64; 2]) {
    ring.push(&Sample { time_s: sample[0], input: (), outputs: [sample[1]] });
}

#[unsafe(no_mangle)]
pub extern "C" fn ring_newest(ring: &Ring, out: &mut u64) {
    *out = ring.newest();
}

#[unsafe(no_mangle)]
pub extern "C" fn ring_clear(ring: &mut Ring) {
    ring.clear();
}

#[unsafe(no_mangle)]
pub extern "C" fn ring_before(ring: &Ring, number: &u64, out: &mut [u64; 2]) {
    *out = ring.before(*number).map_or([0; 2], |snapshot| [1, snapshot.frame]);
}

/// Tells the linker that all of them are in use.
pub(crate) fn keep() {
    core::hint::black_box(ring_frame as *const ());
    core::hint::black_box(ring_push as *const ());
    core::hint::black_box(ring_newest as *const ());
    core::hint::black_box(ring_clear as *const ());
    core::hint::black_box(ring_before as *const ());
}
