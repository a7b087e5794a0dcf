//! From the embedded data files, in slug, foot and degree as published, to SI and radians: the one place of conversion.

use serde::Deserialize;
use std::collections::BTreeMap;

use super::{AerodynamicTables, Engine, F16, F16Constants, F16Options, F16Tables, ThrustTables};
use crate::actuator::{Actuator, Actuators};
use crate::aircraft::Geometry;
use crate::atmosphere::Atmosphere;
use crate::mass::MassProperties;
use crate::table::UniformAxis;

const CONSTANTS: &str = include_str!("../../../../data/f16/stevens_lewis/constants_and_equations.json");
const BOOK: &str = include_str!("../../../../data/f16/stevens_lewis/tables_book3ed.json");
const MORELLI: &str = include_str!("../../../../data/f16/stevens_lewis/tables_morelli.json");

const FOOT: f64 = 0.3048;
const POUND_FORCE: f64 = 4.448_221_615_260_5;
const SLUG: f64 = POUND_FORCE / FOOT;
const SLUG_FOOT_2: f64 = SLUG * FOOT * FOOT;
const DEGREE: f64 = core::f64::consts::PI / 180.0;
/// The book's `RM`, 1/slug (subroutine F; the file holds it as an alternative mass).
const BOOK_INVERSE_MASS: &str = "AeroBench_RM_1_over_mass";

/// The embedded F-16 data cannot be used, or the options ask for something impossible.
#[derive(Debug, thiserror::Error)]
pub enum F16DataError {
    /// A data file is not what it should be.
    #[error("F-16 data file {file}: {source}")]
    Json {
        /// Name of the data file.
        file: &'static str,
        /// What the reader says, with line and column.
        source: serde_json::Error,
    },
    /// A table is missing, or of another shape than expected.
    #[error("F-16 data file {file}, table {table}: found {found}, expected {expected}")]
    Table {
        /// Name of the data file.
        file: &'static str,
        /// Name of the table in the file.
        table: &'static str,
        /// What the file has in this place.
        found: String,
        /// What the loader expects in this place.
        expected: String,
    },
    /// Mass and inertia that no body has.
    #[error("F-16 data file constants_and_equations.json: mass and inertia are not positive definite")]
    Inertia,
    /// The centre of gravity is not a number on the chord.
    #[error("F-16 centre of gravity {0}: expected a fraction of the mean aerodynamic chord between 0 and 1")]
    CentreOfGravity(f64),
}

impl F16 {
    /// The F-16 from the embedded data files.
    ///
    /// Fails when the centre of gravity is not within the chord; a build whose embedded files are damaged fails always.
    pub fn new(options: F16Options) -> Result<Self, F16DataError> {
        if !(0.0..=1.0).contains(&options.cg) {
            return Err(F16DataError::CentreOfGravity(options.cg));
        }
        let constants: Constants = parse("constants_and_equations.json", CONSTANTS)?;
        let (file, text) = match options.tables {
            F16Tables::Book => ("tables_book3ed.json", BOOK),
            F16Tables::Morelli => ("tables_morelli.json", MORELLI),
        };
        let tables = TableFile { file, tables: parse::<Tables>(file, text)?.tables };
        Ok(Self {
            geometry: Geometry {
                wing_area: constants.reference_area_ft2 * FOOT * FOOT,
                span: constants.span_ft * FOOT,
                mean_chord: constants.mac_ft * FOOT,
                cg: options.cg,
                cg_reference: constants.xcg_ref_frac_mac,
            },
            mass_properties: constants.mass_properties(options.constants)?,
            gravity: constants.g_book_ft_s2 * FOOT,
            atmosphere: Atmosphere::Book,
            aerodynamics: tables.aerodynamics()?,
            engine: Engine { thrust: tables.thrust()? },
            actuators: Actuators {
                elevator: constants.actuators.elevator.actuator(),
                aileron: constants.actuators.aileron.actuator(),
                rudder: constants.actuators.rudder.actuator(),
            },
        })
    }
}

fn parse<'a, T: Deserialize<'a>>(file: &'static str, text: &'a str) -> Result<T, F16DataError> {
    serde_json::from_str(text).map_err(|source| F16DataError::Json { file, source })
}

#[derive(Deserialize)]
struct Constants {
    reference_area_ft2: f64,
    span_ft: f64,
    mac_ft: f64,
    xcg_ref_frac_mac: f64,
    weight_lbf: f64,
    g_book_ft_s2: f64,
    alternatives_mass_slug: BTreeMap<String, f64>,
    inertia_slug_ft2: Inertia,
    inertia_constants_1992_rounded: RoundedInertia,
    engine_angular_momentum_slug_ft2_s: f64,
    actuators: SurfaceActuators,
}

#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct Inertia {
    jxx: f64,
    jyy: f64,
    jzz: f64,
    jxz: f64,
}

#[derive(Deserialize)]
struct RoundedInertia {
    c1: f64,
    c2: f64,
    c3: f64,
    c4: f64,
    c5: f64,
    c6: f64,
    c7: f64,
    c8: f64,
    c9: f64,
}

#[derive(Deserialize)]
struct SurfaceActuators {
    elevator: SurfaceActuator,
    aileron: SurfaceActuator,
    rudder: SurfaceActuator,
}

#[derive(Deserialize)]
struct SurfaceActuator {
    limit_deg: f64,
    rate_deg_s: f64,
    lag_s: f64,
}

impl SurfaceActuator {
    fn actuator(&self) -> Actuator {
        Actuator::new(self.limit_deg * DEGREE, self.rate_deg_s * DEGREE, self.lag_s)
    }
}

impl Constants {
    fn mass_properties(&self, choice: F16Constants) -> Result<MassProperties, F16DataError> {
        let momentum = self.engine_angular_momentum_slug_ft2_s * SLUG_FOOT_2;
        match choice {
            F16Constants::Exact => {
                let mass = self.weight_lbf / self.g_book_ft_s2 * SLUG;
                let Inertia { jxx, jyy, jzz, jxz } = self.inertia_slug_ft2;
                let tensor = [[jxx, 0.0, -jxz], [0.0, jyy, 0.0], [-jxz, 0.0, jzz]].map(|r| r.map(|j| j * SLUG_FOOT_2));
                MassProperties::from_tensor(mass, tensor, momentum)
            }
            F16Constants::BookRounded => {
                let inverse_mass = self.alternatives_mass_slug.get(BOOK_INVERSE_MASS).ok_or(F16DataError::Inertia)?;
                let c = &self.inertia_constants_1992_rounded;
                let per = 1.0 / SLUG_FOOT_2;
                let c = [c.c1, c.c2, c.c3 * per, c.c4 * per, c.c5, c.c6, c.c7 * per, c.c8, c.c9 * per];
                MassProperties::from_stevens_lewis_constants(SLUG / inverse_mass, c, momentum)
            }
        }
        .ok_or(F16DataError::Inertia)
    }
}

#[derive(Deserialize)]
struct Tables {
    tables: BTreeMap<String, Table>,
}

#[derive(Deserialize)]
struct Table {
    axes: Vec<Axis>,
    values: Values,
}

#[derive(Deserialize)]
struct Axis {
    name: String,
    units: String,
    values: Vec<Point>,
}

/// A point of an axis: a number, or the name of a coefficient.
#[derive(Deserialize)]
#[serde(untagged)]
enum Point {
    Number(f64),
    Name(String),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Values {
    Rows(Vec<Vec<f64>>),
    Row(Vec<f64>),
}

struct TableFile {
    file: &'static str,
    tables: BTreeMap<String, Table>,
}

/// A table of `R` rows and `C` columns, and the points of its row axis.
struct Grid<'a, const R: usize, const C: usize> {
    rows: &'a [Point],
    columns: UniformAxis<C>,
    values: [[f64; C]; R],
}

impl TableFile {
    fn error(&self, table: &'static str, found: impl Into<String>, expected: impl Into<String>) -> F16DataError {
        F16DataError::Table { file: self.file, table, found: found.into(), expected: expected.into() }
    }

    fn table(&self, name: &'static str, axes: &[(&str, &str)]) -> Result<&Table, F16DataError> {
        let table = self.tables.get(name).ok_or_else(|| self.error(name, "no such table", "a table"))?;
        let found: Vec<(&str, &str)> = table.axes.iter().map(|a| (a.name.as_str(), a.units.as_str())).collect();
        if found == axes {
            Ok(table)
        } else {
            Err(self.error(name, format!("axes {found:?}"), format!("axes {axes:?} (name, unit)")))
        }
    }

    fn axis<const N: usize>(&self, name: &'static str, axis: &Axis) -> Result<UniformAxis<N>, F16DataError> {
        let points: Vec<f64> =
            axis.values.iter().filter_map(|p| if let Point::Number(x) = p { Some(*x) } else { None }).collect();
        let scale = match axis.units.as_str() {
            "deg" => DEGREE,
            "ft" => FOOT,
            _ => 1.0,
        };
        UniformAxis::from_points(&points).map(|a| a.scaled(scale)).ok_or_else(|| {
            self.error(name, format!("axis {} {points:?}", axis.name), format!("{N} evenly spaced points"))
        })
    }

    fn row<const C: usize>(&self, name: &'static str, row: &[f64]) -> Result<[f64; C], F16DataError> {
        row.try_into().map_err(|_| self.error(name, format!("a row of {} values", row.len()), format!("{C} values")))
    }

    fn grid<const R: usize, const C: usize>(
        &self,
        name: &'static str,
        axes: [(&str, &str); 2],
    ) -> Result<Grid<'_, R, C>, F16DataError> {
        let table = self.table(name, &axes)?;
        let Values::Rows(rows) = &table.values else {
            return Err(self.error(name, "one row of values", format!("{R} rows")));
        };
        if rows.len() != R || table.axes[0].values.len() != R {
            return Err(self.error(name, format!("{} rows", rows.len()), format!("{R} rows")));
        }
        let mut values = [[0.0; C]; R];
        for (to, from) in values.iter_mut().zip(rows) {
            *to = self.row(name, from)?;
        }
        Ok(Grid { rows: &table.axes[0].values, columns: self.axis(name, &table.axes[1])?, values })
    }

    /// Row axis of a table, where it is numeric.
    fn row_axis<const N: usize>(
        &self,
        name: &'static str,
        axes: [(&str, &str); 2],
    ) -> Result<UniformAxis<N>, F16DataError> {
        self.axis(name, &self.table(name, &axes)?.axes[0])
    }

    fn aerodynamics(&self) -> Result<AerodynamicTables, F16DataError> {
        const ALPHA: (&str, &str) = ("alpha", "deg");
        const ELEVATOR: [(&str, &str); 2] = [("elevator", "deg"), ALPHA];
        const MAGNITUDE: [(&str, &str); 2] = [("abs_beta", "deg"), ALPHA];
        const SIDESLIP: [(&str, &str); 2] = [("beta", "deg"), ALPHA];

        let (cx, cm) = (self.grid::<5, 12>("CX", ELEVATOR)?, self.grid::<5, 12>("CM", ELEVATOR)?);
        let (cl, cn) = (self.grid::<7, 12>("CL", MAGNITUDE)?, self.grid::<7, 12>("CN", MAGNITUDE)?);
        let controls = [
            self.grid::<7, 12>("DLDA", SIDESLIP)?,
            self.grid::<7, 12>("DLDR", SIDESLIP)?,
            self.grid::<7, 12>("DNDA", SIDESLIP)?,
            self.grid::<7, 12>("DNDR", SIDESLIP)?,
        ];
        let cz_table = self.table("CZ", &[ALPHA])?;
        let Values::Row(cz) = &cz_table.values else {
            return Err(self.error("CZ", "several rows", "one row of 12 values"));
        };
        let cz: [f64; 12] = self.row("CZ", cz)?;

        let damping = self.grid::<9, 12>("DAMP", [("coefficient", "-"), ALPHA])?;
        let derivative = |name: &str| {
            let row = damping.rows.iter().position(|p| matches!(p, Point::Name(n) if n == name));
            row.map(|row| damping.values[row])
                .ok_or_else(|| self.error("DAMP", format!("no row {name}"), "CXq CYr CYp CZq Clr Clp Cmq Cnr Cnp"))
        };
        let pitch = [cz, derivative("CXq")?, derivative("CZq")?, derivative("Cmq")?];
        let lateral = [
            derivative("CYr")?,
            derivative("CYp")?,
            derivative("Clr")?,
            derivative("Clp")?,
            derivative("Cnr")?,
            derivative("Cnp")?,
        ];

        // One axis serves all tables: they must agree on it.
        let alpha = cx.columns;
        let others = [cm.columns, cl.columns, cn.columns, damping.columns, self.axis("CZ", &cz_table.axes[0])?];
        if !others.iter().chain(controls.iter().map(|g| &g.columns)).all(|a| *a == alpha) {
            return Err(self.error("CX", "angle-of-attack axes that differ", "one axis for all tables"));
        }
        use core::array::from_fn;
        Ok(AerodynamicTables {
            alpha,
            elevator: self.row_axis("CX", ELEVATOR)?,
            sideslip_magnitude: self.row_axis("CL", MAGNITUDE)?,
            sideslip: self.row_axis("DLDA", SIDESLIP)?,
            elevator_group: from_fn(|r| from_fn(|c| [cx.values[r][c], cm.values[r][c]])),
            pitch_group: from_fn(|c| from_fn(|k| pitch[k][c])),
            lateral_group: from_fn(|c| from_fn(|k| lateral[k][c])),
            sideslip_group: from_fn(|r| from_fn(|c| [cl.values[r][c], cn.values[r][c]])),
            control_group: from_fn(|r| from_fn(|c| from_fn(|k| controls[k].values[r][c]))),
        })
    }

    fn thrust(&self) -> Result<ThrustTables, F16DataError> {
        const AXES: [(&str, &str); 2] = [("mach", "-"), ("altitude", "ft")];
        let levels = [
            self.grid::<6, 6>("THRUST_IDLE", AXES)?,
            self.grid::<6, 6>("THRUST_MIL", AXES)?,
            self.grid::<6, 6>("THRUST_MAX", AXES)?,
        ];
        use core::array::from_fn;
        Ok(ThrustTables {
            mach: self.row_axis("THRUST_IDLE", AXES)?,
            altitude: levels[0].columns,
            thrust: from_fn(|r| from_fn(|c| from_fn(|k| levels[k].values[r][c] * POUND_FORCE))),
        })
    }
}
