//! Makes files of which a few bytes ask for much memory, in every format that this build reads.

use crate::logs;

/// Name and content of each.
pub(crate) fn files() -> Vec<(&'static str, Vec<u8>)> {
    let always = vec![
        ("header-of-commas.csv", header_of_commas()),
        ("long-names.ulg", long_names()),
        ("many-definitions.ulg", many_definitions()),
        ("many-parameters.ulg", many_parameters()),
    ];
    let formats = [
        always,
        #[cfg(feature = "mcap")]
        mcap::files(),
        #[cfg(feature = "matlab")]
        matlab::files(),
        #[cfg(feature = "parquet")]
        columnar::files(),
    ];
    formats.into_iter().flatten().collect()
}

/// A header whose quoted names hold line ends, with a million cells on each of its lines.
fn header_of_commas() -> Vec<u8> {
    let mut text = b"time,\"".to_vec();
    for _ in 0..40 {
        text.extend(b"\n\"");
        text.resize(text.len() + 500_000, b',');
        text.extend(b"\"");
    }
    text
}

/// A definition of 60,000 bytes whose fields, laid out, have names of four thousand million bytes.
fn long_names() -> Vec<u8> {
    let mut log = logs::ulog_head();
    let text = format!("long:uint64_t timestamp;uint8_t[60000] {};", "x".repeat(60_000));
    log.extend(logs::ulog_message(b'F', text.as_bytes()));
    log.extend(logs::ulog_message(b'A', b"\0\x03\0long"));
    let mut sample = 3_u16.to_le_bytes().to_vec();
    sample.resize(2 + 60_008, 1);
    log.extend(logs::ulog_message(b'D', &sample));
    log.extend(logs::ulog_imu(0, 6_000_000, 0));
    log
}

/// Definitions of many short fields, which take many times their bytes.
fn many_definitions() -> Vec<u8> {
    let mut log = logs::ulog_head();
    let fields = "a b;".repeat(16_000);
    for name in 0..40 {
        log.extend(logs::ulog_message(b'F', format!("f{name}:{fields}").as_bytes()));
    }
    log.extend(logs::ulog_imu(0, 6_000_000, 0));
    log
}

/// Parameters with names of their own, which take many times their bytes.
fn many_parameters() -> Vec<u8> {
    let mut log = logs::ulog_head();
    for name in 0..200_000 {
        log.extend(logs::ulog_key(b'P', &format!("float {name:x}"), &[0; 4]));
    }
    log.extend(logs::ulog_imu(0, 6_000_000, 0));
    log
}

/// Definitions that cannot be understood, each of which is worth a line in the report.
pub(crate) fn many_complaints() -> Vec<u8> {
    let mut log = logs::ulog_head();
    for _ in 0..5000 {
        log.extend(logs::ulog_message(b'F', b"a:b"));
    }
    log.extend(logs::ulog_imu(0, 6_000_000, 0));
    log
}

/// Two definitions of one message in turn, each of which is worth a line in the report.
pub(crate) fn redefined() -> Vec<u8> {
    let mut log = logs::dataflash(3);
    let columns = "A,B,C,D,E,F,G,H,I,J,K,L,M,N,O,P";
    let [one, other] = ["ONE", "TWO"].map(|name| logs::dataflash_define(200, 19, name, "BBBBBBBBBBBBBBBB", columns));
    for _ in 0..5000 {
        log.extend(&one);
        log.extend(&other);
    }
    log.extend(logs::dataflash_imu(3_000_000, 0, 1.0));
    log
}

#[cfg(feature = "mcap")]
mod mcap {
    pub(super) fn files() -> Vec<(&'static str, Vec<u8>)> {
        let written = |name: &str| {
            let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/mcap");
            std::fs::read(folder.join(name)).unwrap()
        };
        let mut files = Vec::new();
        for (name, compression) in [("packed-size-none.mcap", "none.mcap"), ("packed-size-zstd.mcap", "zstd.mcap")] {
            let mut file = written(compression);
            let at = first_chunk(&file) + 9 + 28;
            let word = u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
            file[at + 4 + word..at + 4 + word + 8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
            files.push((name, file));
        }
        for (name, sum) in [("unpacked-size.mcap", true), ("unpacked-size-unchecked.mcap", false)] {
            let mut file = written("zstd.mcap");
            let at = first_chunk(&file) + 9 + 16;
            file[at..at + 8].copy_from_slice(&(1_u64 << 40).to_le_bytes());
            if !sum {
                file[at + 8..at + 12].fill(0);
            }
            files.push((name, file));
        }
        let mut file = written("unchunked.mcap");
        let length = file.len() as u64;
        // The length of the first record of the file, then of the first chunk.
        file[9..17].copy_from_slice(&(length * 1000).to_le_bytes());
        files.push(("record-length.mcap", file));
        let mut file = written("zstd.mcap");
        let at = first_chunk(&file);
        file[at + 1..at + 9].copy_from_slice(&0x7FFF_FFFF_u64.to_le_bytes());
        files.push(("chunk-length.mcap", file));
        let mut file = written("zstd.mcap");
        let at = first_chunk(&file) + 9 + 28;
        file[at..at + 4].copy_from_slice(&0x7FFF_FFFF_u32.to_le_bytes());
        files.push(("compression-length.mcap", file));
        files.push(("schema-length.mcap", records(&[(3, schema_of(0x7FFF_FFFF))])));
        files.push(("zeros.mcap", zeros()));
        files.push(("long-names.mcap", long_names()));
        files.push(("wide-and-narrow.mcap", wide_and_narrow()));
        files.push(("many-numbers.mcap", many_numbers()));
        files
    }

    fn first_chunk(bytes: &[u8]) -> usize {
        let mut at = 8;
        while bytes[at] != 6 {
            at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        }
        at
    }

    fn records(records: &[(u8, Vec<u8>)]) -> Vec<u8> {
        let mut file = b"\x89MCAP0\r\n".to_vec();
        for (opcode, content) in [(1_u8, vec![0; 8])].iter().chain(records) {
            file.push(*opcode);
            file.extend((content.len() as u64).to_le_bytes());
            file.extend(content);
        }
        file
    }

    fn text(text: &str) -> Vec<u8> {
        [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
    }

    fn schema_of(length: u32) -> Vec<u8> {
        [1_u16.to_le_bytes().to_vec(), text("s"), text("jsonschema"), length.to_le_bytes().to_vec()].concat()
    }

    fn channel() -> (u8, Vec<u8>) {
        (4, [vec![0; 4], text("t"), text("json"), vec![0; 4]].concat())
    }

    fn message(time: u64, document: &str) -> (u8, Vec<u8>) {
        let head = [vec![0; 6], time.to_le_bytes().to_vec(), time.to_le_bytes().to_vec()].concat();
        (5, [head, document.as_bytes().to_vec()].concat())
    }

    /// A few thousand bytes of zstd that unpack to forty million zeros.
    fn zeros() -> Vec<u8> {
        // Frame without size and check sum, window of 128 KiB; blocks of one byte repeated (RFC 8878).
        let mut frame = vec![0x28, 0xB5, 0x2F, 0xFD, 0x00, 0x38];
        for block in 0..320_u32 {
            let head = (131_072 << 3) | 2 | u32::from(block == 319);
            frame.extend(&head.to_le_bytes()[..3]);
            frame.push(0);
        }
        let mut chunk = vec![0; 16];
        chunk.extend((320_u64 * 131_072).to_le_bytes());
        chunk.extend([0; 4]);
        chunk.extend(text("zstd"));
        chunk.extend((frame.len() as u64).to_le_bytes());
        chunk.extend(frame);
        records(&[channel(), message(1, "{\"a\": 1}"), (6, chunk), message(2, "{\"a\": 2}")])
    }

    /// A list of numbers under a name of a million bytes: each number has a name of its own.
    fn long_names() -> Vec<u8> {
        let document = format!("{{\"{}\": [{}1]}}", "n".repeat(1_000_000), "1,".repeat(4000));
        records(&[channel(), message(1, &document), message(2, "{\"a\": 2}")])
    }

    /// A message of 4,096 numbers, then many of one: each takes a row of all columns.
    fn wide_and_narrow() -> Vec<u8> {
        let wide = format!("[{}1]", "1,".repeat(4095));
        let mut content = vec![channel(), message(1, &wide)];
        content.extend((0..3000).map(|time| message(time + 2, "[1]")));
        records(&content)
    }

    fn many_numbers() -> Vec<u8> {
        let document = format!("{{\"a\": 1, \"list\": [{}1]}}", "1,".repeat(200_000));
        records(&[channel(), message(1, &document), message(2, "{\"a\": 2}")])
    }
}

#[cfg(feature = "matlab")]
mod matlab {
    use std::io::Write;

    pub(super) fn files() -> Vec<(&'static str, Vec<u8>)> {
        let values = 10_000_000_u32;
        // A matrix of 80 MB of zeros, of which the bytes are there.
        let mut bomb = element(14, 8 * u64::from(values) + 56, &head(6, &[values, 1], "t"));
        bomb.extend(element(9, 8 * u64::from(values), &[]));
        vec![
            ("zeros.mat", file(&[packed(&bomb, 8 * u64::from(values))])),
            ("fields.mat", file(&[packed(&fields(), 0)])),
            ("texts.mat", file(&[packed(&texts(), 0)])),
        ]
    }

    fn file(elements: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = b"MATLAB 5.0 MAT-file, Platform: made by hand".to_vec();
        bytes.resize(124, b' ');
        bytes.extend([0, 1, b'I', b'M']);
        elements.iter().for_each(|element| bytes.extend(element));
        bytes
    }

    fn element(kind: u32, size: u64, content: &[u8]) -> Vec<u8> {
        [&kind.to_le_bytes()[..], &(size as u32).to_le_bytes(), content].concat()
    }

    fn padded(kind: u32, content: &[u8]) -> Vec<u8> {
        let mut bytes = element(kind, content.len() as u64, content);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    /// Flags, dimensions and name of an array.
    fn head(class: u32, dimensions: &[u32], name: &str) -> Vec<u8> {
        let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        [padded(6, &words(&[class, 0])), padded(5, &words(dimensions)), padded(1, name.as_bytes())].concat()
    }

    /// A compressed element: these bytes, then zeros.
    fn packed(start: &[u8], zeros: u64) -> Vec<u8> {
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(start).unwrap();
        for _ in 0..zeros / 1_000_000 {
            encoder.write_all(&[0; 1_000_000]).unwrap();
        }
        let content = encoder.finish().unwrap();
        element(15, content.len() as u64, &content)
    }

    /// A struct of structs of empty fields: 400,000 of them, each eight bytes that compress well.
    fn fields() -> Vec<u8> {
        let fields = |count: usize, content: &[u8]| {
            let names: Vec<u8> = (0..count).flat_map(|name| format!("{name:07x}\0").into_bytes()).collect();
            let mut bytes = [head(2, &[1, 1], "s"), padded(5, &8_u32.to_le_bytes()), padded(1, &names)].concat();
            (0..count).for_each(|_| bytes.extend(content));
            element(14, bytes.len() as u64, &bytes)
        };
        fields(100, &fields(4000, &element(14, 0, &[])))
    }

    /// A cell array of 5,000 texts of 8,000 characters, which take several times their length.
    fn texts() -> Vec<u8> {
        let one = [head(4, &[1, 8000], ""), padded(16, &[b'x'; 8000])].concat();
        let one = element(14, one.len() as u64, &one);
        let mut bytes = head(1, &[5000, 1], "names");
        (0..5000).for_each(|_| bytes.extend(&one));
        element(14, bytes.len() as u64, &bytes)
    }
}

#[cfg(feature = "parquet")]
mod columnar {
    use std::sync::Arc;

    use arrow_array::{ArrayRef, Float64Array, RecordBatch};
    use arrow_schema::{DataType, Field, Schema};

    pub(super) fn files() -> Vec<(&'static str, Vec<u8>)> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/arrow");
        let written = |name: &str| std::fs::read(folder.join(name)).unwrap();
        let mut sizes = written("zstd.feather");
        raise_unpacked_sizes(&mut sizes);
        vec![
            ("unpacked-size.feather", sizes),
            ("body-length.arrows", body_length(written("stream.arrows"))),
            ("columns.arrows", wide_arrow(50_000)),
            ("columns.parquet", footer(50_000, 1)),
            ("groups.parquet", footer(500, 300)),
            ("lists.parquet", lying_list()),
            ("pages.parquet", repeated_page()),
        ]
    }

    /// In front of each packed buffer stands its unpacked size; here they say 700 MB.
    fn raise_unpacked_sizes(file: &mut [u8]) {
        const ZSTD: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];
        let starts: Vec<usize> = (8..file.len() - 4).filter(|&at| file[at..at + 4] == ZSTD).collect();
        assert!(!starts.is_empty());
        for at in starts {
            file[at - 8..at].copy_from_slice(&700_000_000_u64.to_le_bytes());
        }
    }

    /// Makes the body of the first batch end after the end of the file.
    fn body_length(mut file: Vec<u8>) -> Vec<u8> {
        file.truncate(file.len() / 2);
        file
    }

    fn wide_arrow(columns: usize) -> Vec<u8> {
        let fields: Vec<Field> =
            (0..columns).map(|column| Field::new(format!("c{column}"), DataType::Float64, true)).collect();
        let schema = Arc::new(Schema::new(fields));
        let values: ArrayRef = Arc::new(Float64Array::from(vec![0.0, 1.0]));
        let batch = RecordBatch::try_new(Arc::clone(&schema), vec![values; columns]).unwrap();
        let mut writer = arrow_ipc::writer::StreamWriter::try_new(Vec::new(), &schema).unwrap();
        writer.write(&batch).unwrap();
        writer.into_inner().unwrap()
    }

    /// Thrift's compact protocol: an unsigned number.
    fn number(mut value: u64) -> Vec<u8> {
        let mut bytes = Vec::new();
        while value >= 0x80 {
            bytes.push(value as u8 | 0x80);
            value >>= 7;
        }
        bytes.push(value as u8);
        bytes
    }

    fn signed(value: i64) -> Vec<u8> {
        number(((value << 1) ^ (value >> 63)) as u64)
    }

    /// The head of a list of structs.
    fn list(length: usize) -> Vec<u8> {
        [vec![0xFC], number(length as u64)].concat()
    }

    fn parquet(data: &[u8], footer: &[u8]) -> Vec<u8> {
        [b"PAR1", data, footer, &(footer.len() as u32).to_le_bytes(), b"PAR1"].concat()
    }

    fn schema(columns: usize) -> Vec<u8> {
        // Version 1, then the list: a root with its name and number of children, then optional doubles.
        let mut bytes = [vec![0x15, 2, 0x19], list(columns + 1), vec![0x48, 1, b'm', 0x15]].concat();
        bytes.extend([signed(columns as i64), vec![0]].concat());
        for column in 0..columns {
            let name = format!("c{column}");
            bytes.extend([vec![0x15, 10, 0x25, 2, 0x18, name.len() as u8], name.into_bytes(), vec![0]].concat());
        }
        bytes
    }

    /// A chunk of a column: kind, encodings, path, codec, values, sizes, place of its first page.
    fn chunk(column: usize, values: i64, size: i64, at: i64) -> Vec<u8> {
        let name = format!("c{column}");
        let mut meta = vec![0x15, 10, 0x19, 0x15, 0, 0x19, 0x18, name.len() as u8];
        meta.extend(name.into_bytes());
        meta.extend([vec![0x15, 0, 0x16], signed(values), vec![0x16], signed(size), vec![0x16]].concat());
        meta.extend([signed(size), vec![0x26], signed(at), vec![0]].concat());
        [vec![0x26], signed(4), vec![0x1C], meta, vec![0]].concat()
    }

    fn group(columns: usize, values: i64, size: i64, at: i64) -> Vec<u8> {
        let mut bytes = [vec![0x19], list(columns)].concat();
        (0..columns).for_each(|column| bytes.extend(chunk(column, values, size, at)));
        [bytes, vec![0x16], signed(size), vec![0x16], signed(values), vec![0]].concat()
    }

    /// A file of so many columns in so many groups of rows, without data.
    fn footer(columns: usize, groups: usize) -> Vec<u8> {
        let one = group(columns, 1, 1, 4);
        let mut bytes = [schema(columns), vec![0x16], signed(groups as i64), vec![0x19], list(groups)].concat();
        (0..groups).for_each(|_| bytes.extend(&one));
        bytes.push(0);
        parquet(&[], &bytes)
    }

    /// A list of two thousand million elements, none of which is there.
    fn lying_list() -> Vec<u8> {
        let bytes = [vec![0x15, 2, 0x19], list(2_000_000_000), vec![0x48, 1, b'm', 0]].concat();
        parquet(&[], &bytes)
    }

    /// A page of ten million values that are all missing, in a few bytes.
    fn repeated_page() -> Vec<u8> {
        let values = 10_000_000_i64;
        let levels = [number((values as u64) << 1), vec![0]].concat();
        let levels = [(levels.len() as u32).to_le_bytes().to_vec(), levels].concat();
        let size = levels.len() as i64;
        let mut page = [vec![0x15, 0, 0x15], signed(size), vec![0x15], signed(size), vec![0x2C, 0x15]].concat();
        page.extend([signed(values), vec![0x15, 0, 0x15, 6, 0x15, 6, 0, 0], levels].concat());
        let group = group(1, values, page.len() as i64, 4);
        let bytes = [schema(1), vec![0x16], signed(values), vec![0x19], list(1), group, vec![0]].concat();
        parquet(&page, &bytes)
    }
}
