//! Damaged files of every format that this build reads: the same number gives the same file in every run.

use crate::logs;

/// Intact files, small, one of each kind that a reader tells apart.
pub(crate) fn intact() -> Vec<(String, Vec<u8>)> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = vec![
        ("made.ulg".to_owned(), logs::ulog(30)),
        ("made.bin".to_owned(), logs::dataflash(60)),
        ("made.tlog".to_owned(), logs::tlog(30)),
        ("flight.csv".to_owned(), std::fs::read(folder.join("examples/flight.csv")).unwrap()),
    ];
    for (format, read) in [
        ("excel", cfg!(feature = "excel")),
        ("mcap", cfg!(feature = "mcap")),
        ("matlab", cfg!(feature = "matlab")),
        ("arrow", cfg!(feature = "parquet")),
        ("parquet", cfg!(feature = "parquet")),
    ] {
        let entries = std::fs::read_dir(folder.join("tests/data").join(format)).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().path()).filter(|_| read).collect();
        names.sort();
        let name = |path: &std::path::Path| format!("{format}-{}", path.file_name().unwrap().to_string_lossy());
        files.extend(names.iter().map(|path| (name(path), std::fs::read(path).unwrap())));
    }
    files
}

/// The damaged file with this number: one of the intact ones cut, with bits turned, with bytes set, or with a number in
/// it raised.
pub(crate) fn file(intact: &[(String, Vec<u8>)], number: u64) -> (&str, Vec<u8>) {
    let mut random = Random(number.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let (name, bytes) = &intact[(number % intact.len() as u64) as usize];
    let mut bytes = bytes.clone();
    let kind = random.below(6);
    if kind == 0 {
        bytes.truncate(random.below(bytes.len()));
        return (name, bytes);
    }
    for _ in 0..=random.below(3) {
        let at = random.below(bytes.len());
        match kind {
            1 => bytes[at] ^= 1 << random.below(8),
            2 => bytes[at] = [0, 0x7F, 0x80, 0xFF, random.below(256) as u8][random.below(5)],
            3 => {
                let end = (at + 1 + random.below(16)).min(bytes.len());
                drop(bytes.drain(at..end));
            }
            _ => raise(&mut bytes, at, &mut random),
        }
        if bytes.is_empty() {
            break;
        }
    }
    (name, bytes)
}

/// Raises the little-endian number that may begin at a place.
fn raise(bytes: &mut [u8], at: usize, random: &mut Random) {
    let width = [2, 4, 8][random.below(3)].min(bytes.len() - at);
    let number = &mut bytes[at..at + width];
    match random.below(4) {
        0 => number.fill(0xFF),
        1 => {
            number.fill(0xFF);
            number[width - 1] = 0x7F;
        }
        2 => number[width - 1] = number[width - 1].wrapping_add(1),
        _ => {
            let byte = random.below(width);
            number[byte] = number[byte].wrapping_add(1 + random.below(255) as u8);
        }
    }
}

/// SplitMix64 (Steele, Lea, Flood 2014).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((mixed ^ (mixed >> 31)) % limit.max(1) as u64) as usize
    }
}
