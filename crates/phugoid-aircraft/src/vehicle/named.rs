//! Variables of DAVE-ML by the standard names of ANSI/AIAA S-119.

use super::error::VehicleError;
use crate::daveml::{Model, Unit, Variable};

/// Dimension of a length over a time, as in [`Unit::dimension`].
pub(crate) const SPEED: [i8; 5] = [1, 0, -1, 0, 0];
pub(crate) const RATE: [i8; 5] = [0, 0, -1, 0, 0];
pub(crate) const LENGTH: [i8; 5] = [1, 0, 0, 0, 0];
pub(crate) const NUMBER: [i8; 5] = [0; 5];
pub(crate) const PRESSURE: [i8; 5] = [-1, 1, -2, 0, 0];
pub(crate) const FORCE: [i8; 5] = [1, 1, -2, 0, 0];
pub(crate) const MOMENT: [i8; 5] = [2, 1, -2, 0, 0];

/// A variable of a model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Output {
    pub(crate) part: usize,
    pub(crate) position: usize,
    pub(crate) unit: Unit,
}

/// Finds outputs by their standard names.
pub(crate) struct Names<'a> {
    pub(crate) models: &'a [Model],
}

impl Names<'_> {
    /// The last variable with this name that is an output, or else of this name at all.
    pub(crate) fn find(&self, name: &str, dimension: [i8; 5]) -> Result<Option<Output>, VehicleError> {
        for marked in [true, false] {
            for (part, model) in self.models.iter().enumerate().rev() {
                let suits = |v: &&Variable| v.name.eq_ignore_ascii_case(name) && (v.is_output || !marked);
                let Some(variable) = model.variables().iter().find(suits) else { continue };
                let position = model.position(&variable.id).map_err(|_| missing(name))?;
                return Ok(Some(Output { part, position, unit: unit(name, &variable.units, dimension)? }));
            }
        }
        Ok(None)
    }

    pub(crate) fn need(&self, name: &str, dimension: [i8; 5]) -> Result<Output, VehicleError> {
        self.find(name, dimension)?.ok_or_else(|| missing(name))
    }

    pub(crate) fn axes(
        &self,
        start: &str,
        axes: [&str; 3],
        dimension: [i8; 5],
    ) -> Result<[Option<Output>; 3], VehicleError> {
        let [x, y, z] = axes.map(|axis| self.find(&format!("{start}_{axis}"), dimension));
        Ok([x?, y?, z?])
    }
}

pub(crate) const ALONG: [&str; 3] = ["X", "Y", "Z"];
pub(crate) const ABOUT: [&str; 3] = ["Roll", "Pitch", "Yaw"];

pub(crate) fn missing(name: &str) -> VehicleError {
    VehicleError::Missing { name: name.to_owned() }
}

pub(crate) fn unit(name: &str, units: &str, dimension: [i8; 5]) -> Result<Unit, VehicleError> {
    let found = Unit::parse(units).filter(|unit| unit.dimension == dimension);
    found.ok_or_else(|| VehicleError::Unit { name: name.to_owned(), units: units.to_owned() })
}

/// A unit by its text, whatever its kind; of an unknown one the numbers stay as they are.
pub(crate) fn any_unit(units: &str) -> Unit {
    Unit::parse(units).unwrap_or(Unit { factor: 1.0, offset: 0.0, dimension: NUMBER })
}
