//! Reads variables: numeric arrays, text, structs and lists of text. Of everything else only the name is kept.

use std::io::{self, BufRead, Read};

use flate2::read::ZlibDecoder;

use super::ReadError;
use super::element::{Input, Problem, Tag, bad, kind, width};
use crate::memory::{Account, OverBudget, many};
use crate::quality::QualityReport;
use crate::table::TableError;
use crate::table::columns::MAX_COLUMNS;
use crate::wording::cut;

/// Structs that are nested deeper than this are left out.
const MAX_DEPTH: usize = 8;
/// What a variable or a field takes besides its name and values, bytes: its place among the others, the path to it, and
/// a line of the report if it is left out.
const BYTES_PER_FIELD: usize = 500;
/// Number of damaged variables that are reported one by one.
const MAX_FINDINGS: usize = 20;
/// The longest name or text kept, bytes.
const LONGEST_TEXT: u64 = 1 << 16;

/// The content of a variable.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// A real matrix, column by column.
    Numbers { rows: usize, columns: usize, values: Vec<f64> },
    /// One text, or the rows of a matrix of text, or a cell array of text.
    Texts(Vec<String>),
    /// A struct: names and values of its fields in the order of the file.
    Struct(Vec<(String, Value)>),
    /// Anything else; the text says what it is, as it follows "it is".
    Other(String),
}

/// The variables of a file that can be read; the report names those that were lost, and where.
pub(super) fn read_all(
    reader: &mut impl BufRead,
    source: &str,
    account: &Account,
    report: &mut QualityReport,
) -> Result<Vec<(String, Value)>, ReadError> {
    let io = |error| ReadError::Io { source_name: source.to_owned(), error };
    let mut header = Vec::with_capacity(128);
    reader.by_ref().take(128).read_to_end(&mut header).map_err(io)?;
    let big_endian = byte_order(&header).map_err(|(found, advice)| ReadError::NotMatlab {
        source_name: source.to_owned(),
        found,
        advice,
    })?;
    let mut variables = Vec::new();
    let mut lost: Option<(u64, String)> = None;
    let mut offset = 128;
    while !reader.fill_buf().map_err(io)?.is_empty() {
        let mut outcome = Element::default();
        let result = element(reader, big_endian, account, &mut outcome);
        match result {
            Ok(Some(variable)) => {
                let taken = account.take(many(1, BYTES_PER_FIELD + variable.0.len()));
                taken.map_err(|excess| TableError::from(account.over_so_far(excess, source, "")))?;
                variables.push(variable);
            }
            Ok(None) => {}
            Err(Problem::OverBudget { variable, excess }) => {
                let place = match variable.as_str() {
                    "" => format!("byte {offset}"),
                    name => format!("variable '{}'", cut(name, 40)),
                };
                // Of the numbers of a variable the whole need is known, of its fields only what came so far.
                let at_least = variable.is_empty();
                return Err(TableError::from(OverBudget { at_least, ..account.over(excess, source, place) }).into());
            }
            Err(Problem::Io(error)) if !is_damage_of_one_variable(&error) => return Err(io(error)),
            Err(problem) => {
                let problem = match problem {
                    Problem::Bad(problem) => problem,
                    Problem::Io(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                        "the data end in the middle of a variable".to_owned()
                    }
                    Problem::Io(error) => format!("the compressed data cannot be unpacked: {error}"),
                    Problem::OverBudget { .. } => String::new(),
                };
                let rest = if outcome.resumes { "" } else { "; everything after it is lost too" };
                if report.findings.len() < MAX_FINDINGS {
                    report.warn(
                        format!("byte {offset}"),
                        format!("the variable that begins here is left out, it is damaged ({problem}){rest}"),
                    );
                }
                lost.get_or_insert((offset, problem));
                if !outcome.resumes {
                    break;
                }
            }
        }
        offset += outcome.read;
    }
    match (variables.is_empty(), lost) {
        (true, Some((offset, problem))) => Err(ReadError::Damaged { source_name: source.to_owned(), offset, problem }),
        _ => Ok(variables),
    }
}

/// True for errors that come from the bytes of one variable, not from the disk.
fn is_damage_of_one_variable(error: &io::Error) -> bool {
    use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
    matches!(error.kind(), UnexpectedEof | InvalidData | InvalidInput)
}

/// True if the file is big-endian. The error says what the file is instead, and what the user can do.
fn byte_order(header: &[u8]) -> Result<bool, (&'static str, &'static str)> {
    const SAVE: &str = "In MATLAB: load it and save it with save('flight.mat', '-v7', ...)";
    if header.starts_with(b"MATLAB 7.3") || header.starts_with(b"\x89HDF") {
        return Err(("an HDF5 file (MATLAB 7.3)", SAVE));
    }
    // Version and endian indicator: 0x0100 and `MI` written as a 16-bit number.
    match header.get(124..128) {
        Some([0x00, 0x01, b'I', b'M']) => Ok(false),
        Some([0x01, 0x00, b'M', b'I']) => Ok(true),
        Some([0x00, 0x02, b'I', b'M'] | [0x02, 0x00, b'M', b'I']) => Err(("an HDF5 file (MATLAB 7.3)", SAVE)),
        None => Err(("a file shorter than its header of 128 bytes", "Copy or save it again")),
        Some(_) if header.starts_with(b"MATLAB 5.0") => Err(("one with a damaged header", "Copy or save it again")),
        Some(_) => Err(("something else, perhaps MATLAB 4", SAVE)),
    }
}

/// How much of the file an element took.
#[derive(Default)]
struct Element {
    read: u64,
    /// True if its end was found, so that the next element can be read even if this one was damaged.
    resumes: bool,
}

/// Reads one element of the file: a variable, compressed or not; `None` if it is of another kind.
fn element(
    reader: &mut impl BufRead,
    big_endian: bool,
    account: &Account,
    outcome: &mut Element,
) -> Result<Option<(String, Value)>, Problem> {
    let tag = Input::new(reader, big_endian, 8).tag()?;
    outcome.read = 8;
    if tag.is_small() {
        outcome.resumes = true;
        return Ok(None);
    }
    let mut inside = reader.by_ref().take(tag.size);
    let result = match tag.kind {
        kind::COMPRESSED => compressed(&mut inside, big_endian, account),
        kind::MATRIX => matrix(&mut Input::new(&mut inside, big_endian, tag.size), account, 0).map(Some),
        1..=18 => Ok(None),
        // If the type is wrong, the size is probably wrong too, and the next element cannot be found.
        other => return bad(format!("a data element of type {other}, which there is not")),
    };
    let disk = |result: io::Result<u64>| result.map_err(Problem::Io);
    let rest = disk(io::copy(&mut inside, &mut io::sink()))?;
    // All elements but compressed ones are padded to eight bytes.
    let padding = if tag.kind == kind::COMPRESSED { 0 } else { tag.size.wrapping_neg() % 8 };
    let missing = inside.limit();
    let padded = disk(io::copy(&mut reader.by_ref().take(padding), &mut io::sink()))?;
    outcome.read += tag.size + padded;
    outcome.resumes = missing == 0 && padded == padding;
    match (result, missing, rest) {
        (Ok(_), 1.., _) => bad(format!("{missing} of {} bytes are missing at the end of the file", tag.size)),
        (result, ..) => result,
    }
}

fn compressed(packed: &mut dyn Read, big_endian: bool, account: &Account) -> Result<Option<(String, Value)>, Problem> {
    let mut unpacked = ZlibDecoder::new(packed);
    let tag = Input::new(&mut unpacked, big_endian, 8).tag()?;
    if tag.kind != kind::MATRIX {
        return Ok(None);
    }
    let mut input = Input::new(&mut unpacked, big_endian, tag.size);
    let variable = matrix(&mut input, account, 0)?;
    input.skip(input.left())?;
    // The end of the stream carries its checksum.
    let mut beyond = [0; 16];
    while unpacked.read(&mut beyond)? > 0 {}
    Ok(Some(variable))
}

/// Reads an array: its name and value. Its tag has been read, and `input` ends where the array ends.
fn matrix(input: &mut Input<'_>, account: &Account, depth: usize) -> Result<(String, Value), Problem> {
    // An empty element stands for an empty array, as MATLAB writes it into structs.
    if input.left() == 0 {
        return Ok((String::new(), Value::Other("empty".into())));
    }
    let mut flags = Vec::new();
    let tag = input.tag()?;
    input.within(tag, |input| input.numbers(tag.kind, |word| push(&mut flags, word, 2)))?;
    let Some(&flags) = flags.first() else { return bad("no array flags") };
    let (class, complex) = (flags as u32 & 0xFF, flags as u32 & 0x0800 != 0);
    // Objects are stored in a format that is not documented, without dimensions.
    if matches!(class, 3 | 17) {
        let value = "an object of MATLAB such as a table, a timetable or a datetime; save its columns as arrays, e.g. s = \
                     table2struct(t, 'ToScalar', true); save('flight.mat', '-struct', 's', '-v7')";
        let name = if class == 3 { (dimensions(input)?, text(input)?).1 } else { text(input).unwrap_or_default() };
        return Ok((name, Value::Other(value.into())));
    }
    let dimensions = dimensions(input)?;
    let name = text(input)?;
    let value = match class {
        1 => cells(input, &dimensions, account, depth)?,
        2 => structs(input, &dimensions, account, depth)?,
        4 => characters(input, &dimensions)?,
        5 => Value::Other("a sparse matrix".into()),
        6..=15 if complex => Value::Other("complex".into()),
        6..=15 => numeric(input, &dimensions, account, &name)?,
        16 => Value::Other("a function".into()),
        other => Value::Other(format!("of the unknown class {other}")),
    };
    Ok((name, value))
}

/// Adds a number if there are fewer than `most`; false if there is no room.
fn push(numbers: &mut Vec<f64>, number: f64, most: usize) -> bool {
    let room = numbers.len() < most;
    if room {
        numbers.push(number);
    }
    room
}

fn dimensions(input: &mut Input<'_>) -> Result<Vec<usize>, Problem> {
    let tag = input.tag()?;
    let mut sizes = Vec::new();
    input.within(tag, |input| input.numbers(tag.kind, |size| push(&mut sizes, size, 33)))?;
    if sizes.len() < 2 || sizes.len() > 32 || sizes.iter().any(|&size| size < 0.0 || size.fract() != 0.0) {
        return bad(format!("dimensions {sizes:?}"));
    }
    Ok(sizes.into_iter().map(|size| size as usize).collect())
}

/// Reads the bytes of a name or of a block of names.
fn bytes(input: &mut Input<'_>) -> Result<Vec<u8>, Problem> {
    let tag = input.tag()?;
    if tag.size > LONGEST_TEXT {
        return bad(format!("a name of {} bytes", tag.size));
    }
    let mut bytes = Vec::new();
    let kind = if tag.kind == kind::UTF8 { kind::UINT8 } else { tag.kind };
    input.within(tag, |input| {
        input.numbers(kind, |byte| {
            bytes.push(if byte < 0.0 { byte + 256.0 } else { byte } as u8);
            true
        })
    })?;
    Ok(bytes)
}

fn text(input: &mut Input<'_>) -> Result<String, Problem> {
    Ok(to_text(&bytes(input)?))
}

/// The name in these bytes, up to the first zero byte.
fn to_text(bytes: &[u8]) -> String {
    let name = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
    String::from_utf8_lossy(name).into_owned()
}

fn numeric(input: &mut Input<'_>, dimensions: &[usize], account: &Account, name: &str) -> Result<Value, Problem> {
    let count = dimensions.iter().try_fold(1_usize, |product, &size| product.checked_mul(size));
    let (&[rows, columns], Some(count)) = (dimensions, count) else {
        return Ok(Value::Other(format!("an array of {}", in_words(dimensions))));
    };
    if rows.min(columns) > MAX_COLUMNS {
        return Ok(Value::Other(format!("a matrix of {}", in_words(dimensions))));
    }
    let tag = input.tag()?;
    let stored = tag.size / width(tag.kind)?;
    if stored != count as u64 {
        let matrix = in_words(dimensions);
        return bad(format!("'{}' is a matrix of {matrix} but has {stored} values", cut(name, 40)));
    }
    // Counted before the first value is read: a few bytes of zeros, packed, may stand for many.
    let needed = many(count, 8);
    account.take(needed).map_err(|excess| Problem::OverBudget { variable: name.to_owned(), excess })?;
    let mut values = Vec::new();
    let read = input.within(tag, |input| {
        values.reserve_exact(count);
        input.numbers(tag.kind, |value| push(&mut values, value, count))
    });
    if let Err(problem) = read {
        account.give_back(needed);
        return Err(problem);
    }
    Ok(Value::Numbers { rows, columns, values })
}

/// Dimensions as text: `3 x 4`.
pub(super) fn in_words(dimensions: &[usize]) -> String {
    dimensions.iter().map(usize::to_string).collect::<Vec<_>>().join(" x ")
}

/// Reads the rows of a matrix of characters.
fn characters(input: &mut Input<'_>, dimensions: &[usize]) -> Result<Value, Problem> {
    let &[rows, columns] = dimensions else { return Ok(Value::Other("an array of text".into())) };
    let tag = input.tag()?;
    if tag.size > LONGEST_TEXT || rows > MAX_COLUMNS {
        return Ok(Value::Other("a long text".into()));
    }
    let mut units: Vec<u16> = Vec::new();
    let kind = match tag.kind {
        kind::UTF8 => kind::UINT8,
        kind::UTF16 => kind::UINT16,
        other => other,
    };
    input.within(tag, |input| {
        input.numbers(kind, |unit| {
            units.push(unit as u16);
            true
        })
    })?;
    let whole = if tag.kind == kind::UTF8 {
        let bytes: Vec<u8> = units.iter().map(|&unit| unit as u8).collect();
        String::from_utf8_lossy(&bytes).into_owned()
    } else {
        String::from_utf16_lossy(&units)
    };
    if rows <= 1 {
        return Ok(Value::Texts(vec![whole.trim_end().to_owned()]));
    }
    // Characters are stored column by column, so that a row is every `rows`-th character.
    let all: Vec<char> = whole.chars().collect();
    if all.len() != rows.saturating_mul(columns) {
        return bad(format!("text of {} with {} characters", in_words(dimensions), all.len()));
    }
    let row = |row: usize| all.iter().skip(row).step_by(rows).collect::<String>().trim_end().to_owned();
    Ok(Value::Texts((0..rows).map(row).collect()))
}

/// Reads a cell array. One of text is a list; the content of others is not kept.
fn cells(input: &mut Input<'_>, dimensions: &[usize], account: &Account, depth: usize) -> Result<Value, Problem> {
    let other = || Ok(Value::Other("a cell array".into()));
    let count = dimensions.iter().try_fold(1_usize, |product, &size| product.checked_mul(size));
    let Some(count) = count.filter(|&count| count <= MAX_COLUMNS && depth < MAX_DEPTH) else { return other() };
    let mut list = Vec::new();
    for _ in 0..count {
        let tag = matrix_tag(input)?;
        // What is in it and is no text is not kept.
        let before = account.left();
        let (_, value) = input.within(tag, |input| matrix(input, account, depth + 1))?;
        account.give_back(before - account.left());
        match value {
            Value::Texts(mut texts) if texts.len() == 1 => {
                account.take(many(1, texts.first().map_or(0, String::len) + BYTES_PER_FIELD))?;
                list.append(&mut texts);
            }
            _ => return other(),
        }
    }
    Ok(Value::Texts(list))
}

/// Reads a struct, or an array of structs whose fields are single numbers: each field is then a column.
fn structs(input: &mut Input<'_>, dimensions: &[usize], account: &Account, depth: usize) -> Result<Value, Problem> {
    let tag = input.tag()?;
    let mut lengths = Vec::new();
    input.within(tag, |input| input.numbers(tag.kind, |length| push(&mut lengths, length, 1)))?;
    let Some(length) = lengths.first().filter(|length| (1.0..=4096.0).contains(*length)).map(|length| *length as usize)
    else {
        return bad(format!("fields with names of {lengths:?} bytes"));
    };
    let names: Vec<String> = bytes(input)?.chunks(length).map(to_text).collect();
    let count = dimensions.iter().try_fold(1_usize, |product, &size| product.checked_mul(size)).unwrap_or(0);
    if depth >= MAX_DEPTH || names.is_empty() || names.len() > MAX_COLUMNS || count == 0 {
        return Ok(Value::Other("a nested or empty struct".into()));
    }
    if count == 1 {
        let mut fields = Vec::with_capacity(names.len());
        for name in names {
            let tag = matrix_tag(input)?;
            account.take(many(1, BYTES_PER_FIELD + 2 * name.len()))?;
            let (_, value) = input.within(tag, |input| matrix(input, account, depth + 1))?;
            fields.push((name, value));
        }
        return Ok(Value::Struct(fields));
    }
    let mut fields: Vec<(String, Option<Vec<f64>>)> = names.into_iter().map(|name| (name, Some(Vec::new()))).collect();
    for _ in 0..count {
        for (_, column) in &mut fields {
            let tag = matrix_tag(input)?;
            let before = account.left();
            let (_, value) = input.within(tag, |input| matrix(input, account, depth + 1))?;
            match (value, column.as_mut()) {
                (Value::Numbers { rows: 1, columns: 1, values }, Some(column)) => column.extend(values),
                _ => {
                    account.give_back(before - account.left());
                    *column = None;
                }
            }
        }
    }
    let value = |column: Option<Vec<f64>>| match column {
        Some(values) => Value::Numbers { rows: values.len(), columns: 1, values },
        None => Value::Other("a field of an array of structs that is not a single number everywhere".into()),
    };
    Ok(Value::Struct(fields.into_iter().map(|(name, column)| (name, value(column))).collect()))
}

fn matrix_tag(input: &mut Input<'_>) -> Result<Tag, Problem> {
    let tag = input.tag()?;
    match tag.kind {
        kind::MATRIX => Ok(tag),
        other => bad(format!("an element of type {other} where an array is expected")),
    }
}
