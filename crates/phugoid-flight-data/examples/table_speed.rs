//! How fast a large table of 20 columns is read:
//!
//! ```text
//! cargo run --release -p phugoid-flight-data --example table_speed -- 100000 [csv|commas|quoted|clock|plain]
//! cargo run --release -p phugoid-flight-data --features excel --example table_speed -- 100000 xlsx
//! ```
//!
//! `commas` has decimal commas between semicolons, `quoted` all cells in quotes, `clock` dates and times in place of seconds; `plain`
//! is the least that a reader can do with the standard library. What is printed is the fastest of seven readings, by the clock on the
//! wall and by the time that this program had a processor. With `once` behind it for the instructions, which do not depend on what
//! else the machine does:
//!
//! ```text
//! cargo build --profile dist -p phugoid-flight-data --example table_speed
//! valgrind --tool=callgrind --toggle-collect='*read_table*' target/dist/examples/table_speed 20000 csv once
//! valgrind --tool=callgrind --toggle-collect='*plain_pass*' target/dist/examples/table_speed 20000 plain once
//! ```

#[path = "clock/mod.rs"]
mod clock;
#[path = "../tests/logger_table/mod.rs"]
mod logger_table;

use clock::Clock;
use phugoid_flight_data::csv::{self, CsvOptions};
use std::error::Error;
use std::hint::black_box;

const READINGS: usize = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let rows = arguments.first().map_or(Ok(100_000), |rows| rows.parse())?;
    let text = logger_table::csv(rows);
    let what = arguments.get(1).map_or("csv", String::as_str);
    let bytes = match what {
        "csv" | "plain" => text.into_bytes(),
        "commas" => logger_table::with_decimal_commas(&text).into_bytes(),
        "quoted" => logger_table::quoted(&text).into_bytes(),
        "clock" => logger_table::with_clock(&text).into_bytes(),
        #[cfg(feature = "excel")]
        "xlsx" => workbook::of(&text)?,
        other => {
            return Err(
                format!("`{other}` is none of csv, commas, quoted, clock, plain, xlsx (--features excel)").into()
            );
        }
    };
    let readings = if arguments.iter().any(|word| word == "once") { 1 } else { READINGS };
    let (mut wall_s, mut processor_s) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..readings {
        let clock = Clock::start();
        match what {
            "plain" => drop(black_box(logger_table::plain_pass(std::str::from_utf8(&bytes)?))),
            #[cfg(feature = "excel")]
            "xlsx" => {
                drop(black_box(phugoid_flight_data::excel::read(bytes.as_slice(), "flight", &Default::default())?))
            }
            _ => drop(black_box(read_table(&bytes)?)),
        }
        wall_s = wall_s.min(clock.wall_s());
        processor_s = processor_s.min(clock.processor_s().unwrap_or(f64::NAN));
    }
    let megabytes = bytes.len() as f64 / 1e6;
    println!(
        "{rows} rows, {} bytes, {readings} readings, the fastest: {wall_s:.3} s, {:.0} MB/s; {processor_s:.3} s on a processor, \
         {:.0} MB/s",
        bytes.len(),
        megabytes / wall_s,
        megabytes / processor_s
    );
    Ok(())
}

/// A function of its own, so that callgrind can count what happens in it.
#[inline(never)]
fn read_table(bytes: &[u8]) -> Result<phugoid_flight_data::record::Record, csv::ReadError> {
    csv::read(bytes, "flight", &CsvOptions::default())
}

#[cfg(feature = "excel")]
mod workbook {
    use std::error::Error;
    use std::fmt::Write as _;
    use std::io::{Cursor, Write as _};
    use zip::write::SimpleFileOptions;

    /// The table as a workbook of one sheet, with numbers as numbers and headers as text in their cells.
    pub(super) fn of(text: &str) -> Result<Vec<u8>, Box<dyn Error>> {
        let mut sheet =
            String::from("<worksheet xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\"><sheetData>");
        for (row, line) in text.lines().enumerate() {
            write!(sheet, "<row r=\"{}\">", row + 1)?;
            for (column, cell) in line.split(',').enumerate() {
                let place = format!("{}{}", char::from(b'A' + column as u8), row + 1);
                match row {
                    0 => write!(sheet, "<c r=\"{place}\" t=\"inlineStr\"><is><t>{cell}</t></is></c>")?,
                    _ => write!(sheet, "<c r=\"{place}\"><v>{cell}</v></c>")?,
                }
            }
            sheet.push_str("</row>");
        }
        sheet.push_str("</sheetData></worksheet>");
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        for (name, content) in [
            ("[Content_Types].xml", TYPES),
            ("_rels/.rels", RELATIONS),
            ("xl/workbook.xml", BOOK),
            ("xl/_rels/workbook.xml.rels", BOOK_RELATIONS),
            ("xl/worksheets/sheet1.xml", &sheet),
        ] {
            archive.start_file(name, SimpleFileOptions::default())?;
            archive.write_all(content.as_bytes())?;
        }
        Ok(archive.finish()?.into_inner())
    }

    const TYPES: &str = "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default \
        Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/><Default Extension=\"xml\" \
        ContentType=\"application/xml\"/><Override PartName=\"/xl/workbook.xml\" \
        ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.sheet.main+xml\"/><Override \
        PartName=\"/xl/worksheets/sheet1.xml\" \
        ContentType=\"application/vnd.openxmlformats-officedocument.spreadsheetml.worksheet+xml\"/></Types>";
    const RELATIONS: &str = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship \
        Id=\"rId1\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument\" \
        Target=\"xl/workbook.xml\"/></Relationships>";
    const BOOK: &str = "<workbook xmlns=\"http://schemas.openxmlformats.org/spreadsheetml/2006/main\" \
        xmlns:r=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships\"><sheets><sheet name=\"flight\" sheetId=\"1\" \
        r:id=\"rId1\"/></sheets></workbook>";
    const BOOK_RELATIONS: &str = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship \
        Id=\"rId1\" Type=\"http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet\" \
        Target=\"worksheets/sheet1.xml\"/></Relationships>";
}
