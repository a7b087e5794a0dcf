//! Damage to files, the same in every run: 600 rounds, or as many as `PHUGOID_DAMAGE_ROUNDS` says, which is how the readers are
//! hammered where no nightly compiler fuzzes them (`scripts/fuzz.sh`).

/// Gives `read` the file cut off at many places, and with bytes turned, zeroed, set, repeated and left out.
pub(crate) fn try_all(bytes: &[u8], mut read: impl FnMut(&[u8])) {
    let step = (bytes.len() / 400).max(1);
    for end in (0..bytes.len()).step_by(step) {
        read(&bytes[..end]);
    }
    // A linear congruential generator (Knuth, MMIX), so that the places are the same everywhere.
    let mut state = 17_u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % below.max(1)
    };
    let rounds = std::env::var("PHUGOID_DAMAGE_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(600);
    for round in 0..rounds {
        let mut damaged = bytes.to_vec();
        for _ in 0..=next(3) {
            let at = next(damaged.len());
            let length = (1 + next(8)).min(damaged.len() - at);
            match round % 5 {
                0 => damaged[at] ^= 1 << next(8),
                1 => damaged[at..at + length].fill(0xFF),
                2 => damaged[at..at + length].fill(0),
                3 => drop(damaged.drain(at..at + length)),
                _ => {
                    let again = damaged[at..at + length].to_vec();
                    let to = next(damaged.len());
                    damaged.splice(to..to, again);
                }
            }
        }
        read(&damaged);
    }
}
