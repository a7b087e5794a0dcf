//! Decides which column becomes which channel.

use std::collections::HashMap;

use crate::channels::{self, ChannelSpec};
use crate::printable;
use crate::quality::QualityReport;
use crate::record::Quantity;
use crate::table::header::{self, Conflict, Doubt, Meaning};
use crate::table::misspelt;
use crate::table::time_column;
use crate::table::{ColumnMapping, MappingProblem, TableError, TableOptions};
use crate::units::{self, Unit};
use crate::wording::{Short, list};

/// The largest number of columns that a table may have.
pub(crate) const MAX_COLUMNS: usize = 5000;

/// The head of a table: one header per column, and perhaps a row of units below.
pub(crate) struct Head<'a> {
    pub(crate) source: &'a str,
    /// Line of the header, counted from 1; `None` where the table is no text file.
    pub(crate) line: Option<usize>,
    pub(crate) headers: &'a [String],
    pub(crate) units: Option<&'a [String]>,
    /// Cells of the first row of data, where there is one already: what they hold tells a clock from a number.
    pub(crate) first_row: Option<&'a [String]>,
}

/// The meanings of all headers, and the known channels among them.
struct Meanings {
    headers: Vec<Result<Meaning, Conflict>>,
    present: Vec<&'static str>,
}

impl Meanings {
    fn of(head: &Head<'_>) -> Self {
        let mut headers: Vec<_> = head
            .headers
            .iter()
            .enumerate()
            .map(|(column, header)| header::interpret(header, unit_below(head, column)))
            .collect();
        velocities_over_ground(head, &mut headers);
        let mut present: Vec<&'static str> = headers
            .iter()
            .filter_map(|meaning| match meaning {
                Ok(Meaning::Known { spec, .. }) => Some(spec.name),
                _ => None,
            })
            .collect();
        // `T` beside `time_s` is hardly a second time. If another column has the same channel with a unit, a column
        // without a unit whose name has several meanings is left undecided.
        let stated: Vec<&str> = headers
            .iter()
            .filter_map(|meaning| match meaning {
                Ok(Meaning::Known { spec, unit: Some(_) }) => Some(spec.name),
                _ => None,
            })
            .collect();
        for (meaning, header) in headers.iter_mut().zip(head.headers) {
            if let Ok(Meaning::Known { spec, unit: None }) = meaning
                && stated.contains(&spec.name)
            {
                let namesakes: Vec<&str> = channels::by_any_name(header).iter().map(|spec| spec.name).collect();
                if namesakes.len() > 1 {
                    let doubt = Some(Doubt::Ambiguous(namesakes));
                    *meaning = Ok(Meaning::Unknown { name: header.clone(), unit: None, doubt });
                }
            }
        }
        present.sort_unstable();
        present.dedup();
        Self { headers, present }
    }

    fn has(&self, name: &str) -> bool {
        self.present.contains(&name)
    }
}

/// Takes the meaning of an airspeed from `ve` where it stands beside `vn`: then it is the east component of the velocity
/// over ground.
fn velocities_over_ground(head: &Head<'_>, headers: &mut [Result<Meaning, Conflict>]) {
    if !head.headers.iter().any(|header| header::is_speed_named(header, "vn")) {
        return;
    }
    for (meaning, header) in headers.iter_mut().zip(head.headers).filter(|(_, h)| header::is_speed_named(h, "ve")) {
        if let Ok(Meaning::Known { unit, .. }) = meaning {
            *meaning = Ok(Meaning::Unknown { name: header.clone(), unit: *unit, doubt: None });
        }
    }
}

/// One column and the channel that it becomes.
#[derive(Clone, Debug)]
pub(crate) struct ColumnUse {
    pub(crate) column: usize,
    pub(crate) header: String,
    pub(crate) name: String,
    pub(crate) spec: Option<&'static ChannelSpec>,
    pub(crate) unit: Unit,
    pub(crate) unit_assumed: bool,
    pub(crate) scale: f64,
    /// Further columns that are added, with their factors.
    pub(crate) plus: Vec<(usize, f64)>,
}

impl ColumnUse {
    /// The value in SI from the numbers in its columns; NaN if one is missing.
    pub(crate) fn value(&self, mut number: impl FnMut(usize) -> f64) -> f64 {
        let first = self.scale * number(self.column);
        let sum = self.plus.iter().fold(first, |sum, (column, scale)| sum + scale * number(*column));
        let si = self.unit.to_si(sum);
        // The conversion of a finite number may overflow.
        if si.is_finite() { si } else { f64::NAN }
    }

    /// The indices of all its columns.
    pub(crate) fn columns(&self) -> impl Iterator<Item = usize> {
        [self.column].into_iter().chain(self.plus.iter().map(|(column, _)| *column))
    }
}

/// The time column (`None` if the sample time is given) and the channels in the order of the file.
pub(crate) struct Plan {
    pub(crate) time: Option<ColumnUse>,
    pub(crate) channels: Vec<ColumnUse>,
}

/// Refuses a table of more columns than are read.
pub(crate) fn check_count(source: &str, line: Option<usize>, columns: usize) -> Result<(), TableError> {
    match columns > MAX_COLUMNS {
        true => {
            let (source_name, max_columns) = (source.to_owned(), MAX_COLUMNS);
            Err(TableError::TooManyColumns { source_name, line, columns, max_columns })
        }
        false => Ok(()),
    }
}

/// Decides for every column what it becomes, and reports what was assumed.
pub(crate) fn plan(head: &Head<'_>, options: &TableOptions, report: &mut QualityReport) -> Result<Plan, TableError> {
    check_count(head.source, head.line, head.headers.len())?;
    // From here on the words of the table appear in names and messages.
    let shown =
        |words: &[String]| -> Vec<String> { words.iter().map(|w| printable::one_line(w).into_owned()).collect() };
    let (headers, units) = (shown(head.headers), head.units.map(shown));
    let head = &Head { headers: &headers, units: units.as_deref(), ..*head };
    let mut uses = Vec::new();
    for mapping in &options.columns {
        uses.push(mapped(head, mapping, report)?);
    }
    if let Some((first, second)) = first_pair(&uses, |a, b| a.name == b.name) {
        return Err(two_columns(head, first, second));
    }
    let meanings = Meanings::of(head);
    let mapped_columns: Vec<usize> = uses.iter().flat_map(ColumnUse::columns).collect();
    let mapped_names: Vec<String> = uses.iter().map(|column| column.name.clone()).collect();
    for column in 0..head.headers.len() {
        if !mapped_columns.contains(&column)
            && let Some(used) = automatic(head, column, &meanings, &mapped_names, &uses, report)?
        {
            uses.push(used);
        }
    }
    uses.sort_by_key(|column| column.column);
    make_names_unique(&mut uses, report);

    let mut time = uses.iter().position(|column| column.name == "time").map(|index| uses.remove(index));
    if let (Some(step), Some(column)) = (options.sample_time_s, &time) {
        report.note(
            format!("column '{}'", column.header),
            format!("left out: the sample time is given as {} s, and the rows are counted", Short(step)),
        );
        time = None;
    }
    if time.is_none() && options.sample_time_s.is_none() {
        time = time_column::take(head, &mut uses, report);
        if time.is_none() {
            return Err(no_time(head));
        }
    }
    for column in uses.iter().filter(|column| column.unit_assumed) {
        report_assumed_unit(column, report);
    }
    Ok(Plan { time, channels: uses })
}

/// Warns that a column has no unit and is taken as SI.
pub(crate) fn report_assumed_unit(column: &ColumnUse, report: &mut QualityReport) {
    let quantity = column.unit.quantity;
    let header = &column.header;
    let other = units::UNITS.iter().filter(|unit| unit.quantity == quantity).nth(1).map(|unit| unit.symbol);
    let other = other.map(|other| format!(" or {header}_{other}")).unwrap_or_default();
    report.warn(
        format!("column '{header}'"),
        format!(
            "{} is {} but no unit is written; taken as {} (SI). Write the unit into the header, e.g. {header}_{}{other}",
            column.name,
            quantity.in_words(),
            quantity.si_unit(),
            quantity.si_suffix(),
        ),
    );
}

fn unit_below<'a>(head: &Head<'a>, column: usize) -> Option<&'a str> {
    head.units.and_then(|units| units.get(column)).map(String::as_str)
}

fn mapped(head: &Head<'_>, mapping: &ColumnMapping, report: &mut QualityReport) -> Result<ColumnUse, TableError> {
    let bad = |problem| TableError::BadMapping {
        channel: mapping.channel.clone(),
        header: mapping.header.clone(),
        problem: Box::new(problem),
    };
    if mapping.channel.trim().is_empty() {
        return Err(bad(MappingProblem::NoChannelName));
    }
    if let Some((header, scale)) = mapping.terms().find(|(_, scale)| !scale.is_finite() || *scale == 0.0) {
        let header = (!mapping.plus.is_empty()).then(|| header.to_owned());
        return Err(bad(MappingProblem::Scale { header, scale }));
    }
    let spec = channels::by_name(&mapping.channel);
    if spec.is_none() {
        let synonym = channels::by_any_name(&mapping.channel).first().map(|spec| spec.name);
        if let Some(nearest) = synonym.or_else(|| channels::nearest(&mapping.channel)) {
            return Err(bad(MappingProblem::NotCanonical { channel: mapping.channel.clone(), nearest }));
        }
    }
    let column = find_column(head, mapping, &mapping.header)?;
    let header = head.headers.get(column).cloned().unwrap_or_default();
    let mut plus = Vec::with_capacity(mapping.plus.len());
    for addend in &mapping.plus {
        plus.push((find_column(head, mapping, &addend.header)?, addend.scale));
    }
    let below = unit_below(head, column);
    let quantity = spec.map(|spec| spec.quantity);
    let mut unit_assumed = false;
    let unit = match (&mapping.unit, quantity) {
        (Some(text), Some(quantity)) => units::find_for(text, quantity)
            .ok_or_else(|| bad(MappingProblem::UnitOfChannel { unit: text.clone(), quantity }))?,
        (Some(text), None) => {
            *units::find(text).first().ok_or_else(|| bad(MappingProblem::UnknownUnit { unit: text.clone() }))?
        }
        (None, Some(quantity)) => header::unit_for(&header, below, quantity).unwrap_or_else(|| {
            unit_assumed = quantity != Quantity::Number;
            si(quantity)
        }),
        (None, None) => match header::interpret(&header, below) {
            Ok(Meaning::Known { unit: Some(unit), .. } | Meaning::Unknown { unit: Some(unit), .. }) => unit,
            _ => si(Quantity::Number),
        },
    };
    let place = format!("column '{header}'");
    if !plus.is_empty() {
        let sum: Vec<String> = mapping.terms().map(|(header, scale)| format!("{scale} times '{header}'")).collect();
        report.note(place, format!("{} is {}, as the mapping asks", mapping.channel, sum.join(" plus ")));
    } else if mapping.scale != 1.0 {
        let message = format!("multiplied by {} to become {}, as the mapping asks", mapping.scale, mapping.channel);
        report.note(place, message);
    }
    let (name, scale) = (mapping.channel.clone(), mapping.scale);
    Ok(ColumnUse { column, header, name, spec, unit, unit_assumed, scale, plus })
}

/// The index of the column with this header of a mapping.
fn find_column(head: &Head<'_>, mapping: &ColumnMapping, header: &str) -> Result<usize, TableError> {
    let wanted = printable::one_line(header);
    let wanted = wanted.trim();
    let alike = |loose: bool| -> Vec<usize> {
        let same = |header: &String| match loose {
            true => header.trim().to_lowercase() == wanted.to_lowercase(),
            false => header.trim() == wanted,
        };
        head.headers.iter().enumerate().filter(|(_, header)| same(header)).map(|(column, _)| column).collect()
    };
    let exact = alike(false);
    let found = if exact.is_empty() { alike(true) } else { exact };
    match found.as_slice() {
        [one] => Ok(*one),
        [first, second, ..] => Err(TableError::TwoColumns {
            source_name: head.source.to_owned(),
            line: head.line,
            channel: mapping.channel.clone(),
            columns: Box::new(
                [*first, *second].map(|index| (index + 1, head.headers.get(index).cloned().unwrap_or_default())),
            ),
        }),
        [] => {
            let likeness = |header: &str| {
                strsim::normalized_damerau_levenshtein(&wanted.to_lowercase(), &header.trim().to_lowercase())
            };
            let nearest = head
                .headers
                .iter()
                .map(|header| (header, likeness(header)))
                .filter(|&(_, likeness)| likeness >= 0.6)
                .max_by(|a, b| a.1.total_cmp(&b.1));
            Err(TableError::MappedColumnMissing {
                source_name: head.source.to_owned(),
                line: head.line,
                mapping: Box::new(ColumnMapping::new(&mapping.channel, header)),
                nearest: nearest.map(|(header, _)| format!("; did you mean '{header}'?")).unwrap_or_default(),
                headers: list(head.headers),
            })
        }
    }
}

/// Decides by its header what a column that is not mapped becomes; `None` if it is left out.
fn automatic(
    head: &Head<'_>,
    column: usize,
    meanings: &Meanings,
    mapped_names: &[String],
    uses: &[ColumnUse],
    report: &mut QualityReport,
) -> Result<Option<ColumnUse>, TableError> {
    let header = head.headers.get(column).map(|header| header.trim()).unwrap_or_default().to_owned();
    let place = format!("column '{header}'");
    let Some(meaning) = meanings.headers.get(column).cloned() else { return Ok(None) };
    let meaning = meaning.map_err(|Conflict { first, second }| TableError::TwoUnits {
        source_name: head.source.to_owned(),
        line: head.line,
        column: column + 1,
        header: header.clone(),
        first,
        second,
    })?;
    let meaning = body_velocity(meaning, meanings);
    match meaning {
        Meaning::Known { spec, unit } => {
            if mapped_names.iter().any(|name| name == spec.name) {
                report.note(place, format!("left out: the mapping takes {} from another column", spec.name));
                return Ok(None);
            }
            let used = ColumnUse {
                column,
                header,
                name: spec.name.to_owned(),
                spec: Some(spec),
                unit: unit.unwrap_or_else(|| si(spec.quantity)),
                unit_assumed: unit.is_none() && spec.quantity != Quantity::Number,
                scale: 1.0,
                plus: Vec::new(),
            };
            match uses.iter().find(|other| other.name == spec.name) {
                Some(other) => Err(two_columns(head, other, &used)),
                None => Ok(Some(used)),
            }
        }
        Meaning::Unknown { name, unit, doubt } => {
            let mut name = name;
            match doubt {
                Some(Doubt::Near { name, like, unit: near }) => {
                    let has = meanings.has(name) || mapped_names.iter().any(|mapped| mapped == name);
                    if !has && misspelt::can_be(name, unit) {
                        report.warn(place, misspelt::message(&header, name, like, unit.or(near)));
                    }
                }
                Some(doubt) => doubtful(&place, &doubt, report),
                None => {}
            }
            if name.is_empty() {
                name = format!("column_{}", column + 1);
            }
            name = printable::channel_name(&name);
            // A column that was not recognised must not have the name of a known channel (`v`, which is ambiguous).
            if channels::by_name(&name).is_some() {
                name = format!("{name}?");
            }
            let unit = unit.unwrap_or_else(|| si(Quantity::Number));
            let plus = Vec::new();
            Ok(Some(ColumnUse { column, header, name, spec: None, unit, unit_assumed: false, scale: 1.0, plus }))
        }
    }
}

/// Decides that `v` is the lateral velocity if the table also has `u` or `w`; alone it could be the airspeed as well.
fn body_velocity(meaning: Meaning, meanings: &Meanings) -> Meaning {
    let Meaning::Unknown { unit, doubt: Some(Doubt::Ambiguous(names)), .. } = &meaning else { return meaning };
    let Some(spec) = names.iter().find(|name| **name == "v").and_then(|name| channels::by_name(name)) else {
        return meaning;
    };
    let neighbour = meanings.has("u") || meanings.has("w");
    let suits = unit.is_none_or(|unit| unit.quantity == spec.quantity);
    if neighbour && suits { Meaning::Known { spec, unit: *unit } } else { meaning }
}

fn doubtful(place: &str, doubt: &Doubt, report: &mut QualityReport) {
    match doubt {
        Doubt::Unit { spec, text, found } => {
            let what = match found {
                Some(found) => format!(
                    "'{text}' is {} and no unit of {}",
                    found.in_words(),
                    spec.quantity.in_words()
                ),
                None => format!("'{text}' is no unit that is understood"),
            };
            report.warn(
                place,
                format!(
                    "looks like {} ({}), but {what}; kept as a channel of its own, not as {}. Write one of the units {} \
                     or map it",
                    spec.name,
                    spec.quantity.in_words(),
                    spec.name,
                    units::accepted(spec.quantity)
                ),
            );
        }
        Doubt::Ambiguous(meanings) if meanings.len() == 1 => report.warn(
            place,
            format!(
                "could be {} or something else; not guessed without a unit, kept as a channel of its own. Write its unit \
                 into the header, or map it",
                meanings.join("")
            ),
        ),
        Doubt::Ambiguous(meanings) => report.warn(
            place,
            format!(
                "could be {}; not guessed, kept as a channel of its own. Write which one it is into the header, or map \
                 it",
                meanings.join(" or ")
            ),
        ),
        // Whether the record has the channel from elsewhere is known to the caller.
        Doubt::Near { .. } => {}
    }
}

/// Gives unknown columns of the same name different names. Two columns of a known channel are an error before this.
fn make_names_unique(uses: &mut [ColumnUse], report: &mut QualityReport) {
    let mut taken: HashMap<String, usize> =
        uses.iter().filter(|c| c.spec.is_some()).map(|c| (c.name.clone(), 1)).collect();
    for this in uses.iter_mut().filter(|column| column.spec.is_none()) {
        if taken.contains_key(&this.name) {
            let mut number = taken.get(&this.name).copied().unwrap_or(1);
            let mut free = this.name.clone();
            while taken.contains_key(&free) {
                number += 1;
                free = format!("{}_{number}", this.name);
            }
            taken.insert(std::mem::replace(&mut this.name, free), number);
            report.warn(
                format!("column '{}'", this.header),
                format!("a second column of this name (column {}); kept as '{}'", this.column + 1, this.name),
            );
        }
        taken.insert(this.name.clone(), 1);
    }
}

/// The SI unit of a quantity.
pub(super) fn si(quantity: Quantity) -> Unit {
    const NUMBER: Unit = Unit { symbol: "-", quantity: Quantity::Number, scale: 1.0, offset: 0.0 };
    units::UNITS.iter().find(|unit| unit.quantity == quantity).copied().unwrap_or(NUMBER)
}

fn first_pair(uses: &[ColumnUse], same: impl Fn(&ColumnUse, &ColumnUse) -> bool) -> Option<(&ColumnUse, &ColumnUse)> {
    uses.iter().enumerate().find_map(|(index, second)| {
        let first = uses.iter().take(index).find(|first| same(first, second))?;
        Some((first, second))
    })
}

fn two_columns(head: &Head<'_>, first: &ColumnUse, second: &ColumnUse) -> TableError {
    TableError::TwoColumns {
        source_name: head.source.to_owned(),
        line: head.line,
        channel: second.name.clone(),
        columns: Box::new([first, second].map(|used| (used.column + 1, used.header.clone()))),
    }
}

fn no_time(head: &Head<'_>) -> TableError {
    let nearest = head.headers.iter().enumerate().find_map(|(column, header)| {
        match header::interpret(header, unit_below(head, column)) {
            Ok(Meaning::Unknown { doubt: Some(Doubt::Unit { spec, text, .. }), .. }) if spec.name == "time" => {
                Some(format!(" '{header}' looks like it, but '{text}' is no unit of time."))
            }
            _ => {
                let key = channels::key(header);
                let near = |name| strsim::normalized_damerau_levenshtein(&key, name) >= 0.75;
                let alike = key.contains("time") || near("time") || near("times");
                alike.then(|| format!(" '{header}' looks like it."))
            }
        }
    });
    TableError::NoTime {
        source_name: head.source.to_owned(),
        line: head.line,
        headers: if head.headers.is_empty() { "no column at all".to_owned() } else { list(head.headers) },
        nearest: nearest.unwrap_or_default(),
    }
}
