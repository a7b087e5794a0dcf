//! The aerodynamic forces and moments of a file, and their sum about the centre of gravity.

mod compiled;

pub(crate) use compiled::{AerodynamicWorkspace, CompiledAerodynamics};

use phugoid_flight_dynamics::scalar::Scalar;
use roxmltree::Node;

use super::error::{JsbsimError, Omission};
use super::function;
use super::mass::{Metrics, arm_ft};
use super::model::{Model, State};
use super::source::{Source, child, children, shortened, tag};
use super::units::Unit;

/// Axes that forces or moments are given in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Frame {
    /// x forward, y right, z down.
    Body,
    /// Axial backward, side right, normal up; forces only.
    AxialNormal,
    /// Body axes turned by the angle of attack; forces as drag, side and lift.
    Stability,
    /// Turned by the angle of sideslip too; forces as drag, side and lift.
    Wind,
}

/// Functions of a file, and how their values are put together.
#[derive(Debug, Clone)]
pub(super) struct Aerodynamics {
    /// What is computed first, in order.
    before: Vec<usize>,
    after: Vec<usize>,
    /// Sums for x or drag, y or side, z or lift, roll, pitch, yaw.
    axes: [Vec<usize>; 6],
    /// Forces whose moment about the centre of gravity is none.
    at_centre: [Vec<usize>; 3],
    forces: Frame,
    moments: Frame,
    /// Shift of the reference point aft, in chords.
    shift: Option<usize>,
    stall_limits: Option<[f64; 2]>,
    hysteresis_limits: Option<[f64; 2]>,
    p: Own,
}

/// Properties that are read or written here.
#[derive(Debug, Clone, Copy, Default)]
struct Own {
    alpha: usize,
    beta: usize,
    qbar: usize,
    qbar_area: usize,
    cl_squared: usize,
    lift_over_drag: usize,
    stall_warning: usize,
    stall_hysteresis: usize,
    /// Whether the file reads `aero/cl-squared`.
    reads_cl_squared: bool,
}

/// Force and moment of the air in body axes: pounds, and foot pounds about the centre of gravity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sum {
    pub(super) force: [f64; 3],
    pub(super) moment: [f64; 3],
}

impl Aerodynamics {
    /// Reads `<aerodynamics>`.
    pub(super) fn read(
        model: &mut Model,
        source: &Source,
        node: Node<'_, '_>,
        omitted: &mut Vec<Omission>,
    ) -> Result<Self, JsbsimError> {
        let reads_cl_squared = model.find("aero/cl-squared").is_some();
        let mut own = Own {
            alpha: model.property("aero/alpha-rad"),
            beta: model.property("aero/beta-rad"),
            qbar: model.property("aero/qbar-psf"),
            qbar_area: model.property("aero/qbar-area"),
            cl_squared: 0,
            lift_over_drag: model.property("forces/lod-norm"),
            stall_warning: model.property("systems/stall-warn-norm"),
            stall_hysteresis: model.property("aero/stall-hyst-norm"),
            reads_cl_squared,
        };
        let mut read = Self {
            before: Vec::new(),
            after: Vec::new(),
            axes: Default::default(),
            at_centre: Default::default(),
            forces: Frame::Wind,
            moments: Frame::Body,
            shift: None,
            stall_limits: None,
            hysteresis_limits: None,
            p: own,
        };
        let mut lines: [Option<u32>; 6] = [None; 6];
        let mut force_frame = None;
        let mut moment_frame = None;
        for part in children(node) {
            match tag(part) {
                "function" => {
                    let made = function::read(model, source, part)?;
                    let post = part.attribute("type") == Some("post");
                    if post { &mut read.after } else { &mut read.before }.push(made);
                }
                "axis" => {
                    let (axis, frame) = read.read_axis(model, source, part)?;
                    // JSBSim forgets the functions of the first.
                    if let Some(line) = lines[axis].replace(source.line(part)) {
                        let name = part.attribute("name").unwrap_or_default().trim();
                        let what = format!(
                            "the axis {name} is given twice, here and in line {line}: put their functions into one <axis>"
                        );
                        return Err(source.refuse(part, what));
                    }
                    let place = if axis < 3 { &mut force_frame } else { &mut moment_frame };
                    if let (Some(before), Some(now)) = (*place, frame)
                        && before != now
                    {
                        return Err(source.refuse(part, "the file mixes systems of axes"));
                    }
                    *place = place.or(frame);
                }
                "alphalimits" => read.stall_limits = Some(limits(source, part)?),
                "hysteresis_limits" => read.hysteresis_limits = Some(limits(source, part)?),
                "aero_ref_pt_shift_x" => {
                    let inside = child(part, "function")
                        .ok_or_else(|| source.refuse(part, "the shift of the reference point has no <function>"))?;
                    read.shift = Some(function::read(model, source, inside)?);
                }
                "property" => super::declare(model, source, part)?,
                "documentation" | "description" | "limitation" | "note" => {}
                other => omitted.push(source.omit(part, format!("<{}> is left out", shortened(other)))),
            }
        }
        read.forces = force_frame.unwrap_or(Frame::Wind);
        read.moments = moment_frame.unwrap_or(Frame::Body);
        own.reads_cl_squared = own.reads_cl_squared || model.find("aero/cl-squared").is_some();
        own.cl_squared = model.property("aero/cl-squared");
        read.p = own;
        Ok(read)
    }

    /// Reads one axis; gives its number and the frame that it asks for.
    fn read_axis(
        &mut self,
        model: &mut Model,
        source: &Source,
        node: Node<'_, '_>,
    ) -> Result<(usize, Option<Frame>), JsbsimError> {
        let name = node.attribute("name").unwrap_or_default().trim();
        let frame = match node.attribute("frame").map(str::trim) {
            None | Some("") => None,
            Some("BODY") => Some(Frame::Body),
            Some("STABILITY") => Some(Frame::Stability),
            Some("WIND") => Some(Frame::Wind),
            Some(other) => {
                return Err(source.refuse(node, format!("frame=\"{}\" is not known", shortened(other))));
            }
        };
        let turned = matches!(frame, Some(Frame::Stability | Frame::Wind));
        let (axis, frame) = match name {
            "DRAG" if frame != Some(Frame::Body) => (0, frame.or(Some(Frame::Wind))),
            "LIFT" if frame != Some(Frame::Body) => (2, frame.or(Some(Frame::Wind))),
            "SIDE" => (1, frame.filter(|_| turned)),
            "AXIAL" if !turned => (0, Some(Frame::AxialNormal)),
            "NORMAL" if !turned => (2, Some(Frame::AxialNormal)),
            "X" if !turned => (0, Some(Frame::Body)),
            "Y" if !turned => (1, Some(Frame::Body)),
            "Z" if !turned => (2, Some(Frame::Body)),
            "ROLL" => (3, frame.or(Some(Frame::Body))),
            "PITCH" => (4, frame.or(Some(Frame::Body))),
            "YAW" => (5, frame.or(Some(Frame::Body))),
            "DRAG" | "LIFT" | "AXIAL" | "NORMAL" | "X" | "Y" | "Z" => {
                return Err(source.refuse(node, format!("the axis {name} cannot be in this frame")));
            }
            other => {
                return Err(source.refuse(node, format!("the axis \"{}\" is not known", shortened(other))));
            }
        };
        for part in children(node) {
            match tag(part) {
                "function" => {
                    let made = function::read(model, source, part)?;
                    let at_centre = part.attribute("apply_at_cg").map(str::trim) == Some("true");
                    match self.at_centre.get_mut(axis) {
                        Some(list) if at_centre => list.push(made),
                        _ => self.axes[axis].push(made),
                    }
                }
                "documentation" | "description" | "limitation" | "note" => {}
                other => {
                    return Err(source.refuse(part, format!("<{}> in an axis is not supported", shortened(other))));
                }
            }
        }
        Ok((axis, frame))
    }

    /// The functions that it calls itself.
    pub(super) fn functions(&self) -> impl Iterator<Item = usize> {
        let axes = self.axes.iter().chain(&self.at_centre).flatten();
        self.before.iter().chain(&self.after).chain(axes).chain(&self.shift).copied()
    }

    /// Force and moment at the properties as they stand.
    ///
    /// `centre_in` is the centre of gravity, inches in the structural frame. Where the file asks for the square of the lift
    /// coefficient, forces are computed once more with the square that comes out, unless the lift of the step before is given,
    /// pounds: then that is taken with the dynamic pressure of now, as JSBSim does, and replaced by the lift of now.
    pub(super) fn sum(
        &self,
        model: &Model,
        state: &mut State,
        metrics: &Metrics,
        centre_in: [f64; 3],
        mut lift_before: Option<&mut f64>,
    ) -> Sum {
        let stepwise = lift_before.is_some();
        let own = &self.p;
        let (alpha, beta) = (state.read(model, own.alpha), state.read(model, own.beta));
        let qbar = state.read(model, own.qbar);
        state.write(model, own.qbar_area, qbar * metrics.area_ft2);
        self.stall(model, state, alpha);
        let turn = Turn::new(alpha, beta);
        let passes = if own.reads_cl_squared && !stepwise { 2 } else { 1 };
        // As in JSBSim, nothing is said of the coefficient without dynamic pressure.
        let squared = |lift: f64| (lift / (metrics.area_ft2 * qbar)).powi(2);
        if let Some(lift) = lift_before.as_deref()
            && qbar > 1.0
        {
            state.write(model, own.cl_squared, squared(*lift));
        }
        let (mut force, mut at_centre) = ([0.0; 3], [0.0; 3]);
        for _ in 0..passes {
            state.hold(model, &self.before, stepwise);
            force = self.to_body(total(model, state, &self.axes[..3]), &turn);
            at_centre = self.to_body(total(model, state, &self.at_centre), &turn);
            let lift = -transposed_row(&turn.of_wind(), 2, add(force, at_centre));
            let drag = -transposed_row(&turn.of_wind(), 0, add(force, at_centre));
            if let Some(before) = lift_before.as_deref_mut() {
                *before = lift;
            } else if qbar > 1.0 {
                state.write(model, own.cl_squared, squared(lift));
            }
            if drag != 0.0 {
                state.write(model, own.lift_over_drag, (lift / drag).abs());
            }
        }
        let shift = self.shift.map(|shift| state.call(model, shift));
        let given = total(model, state, &self.axes[3..]);
        let sum = self.about_centre([force, at_centre, given], shift, &turn, metrics, centre_in);
        state.hold(model, &self.after, stepwise);
        sum
    }

    /// The sum of forces in body axes, those whose moment about the centre of gravity is none, and moments as they are given.
    fn about_centre(
        &self,
        [force, at_centre, given]: [[f64; 3]; 3],
        shift: Option<f64>,
        turn: &Turn,
        metrics: &Metrics,
        centre_in: [f64; 3],
    ) -> Sum {
        let mut reference = metrics.reference_in;
        if let Some(shift) = shift {
            // Aft is positive in the structural frame.
            reference[0] += 12.0 * metrics.chord_ft * shift;
        }
        let arm = arm_ft(reference, centre_in);
        let moment = match self.moments {
            Frame::Body | Frame::AxialNormal => given,
            Frame::Stability => rotate(&turn.of_stability(), given),
            Frame::Wind => rotate(&turn.of_wind(), given),
        };
        Sum { force: add(force, at_centre), moment: add(moment, cross(arm, force)) }
    }

    fn to_body(&self, given: [f64; 3], turn: &Turn) -> [f64; 3] {
        let backward_up = [-given[0], given[1], -given[2]];
        match self.forces {
            Frame::Body => given,
            Frame::AxialNormal => backward_up,
            Frame::Stability => rotate(&turn.of_stability(), backward_up),
            Frame::Wind => rotate(&turn.of_wind(), backward_up),
        }
    }

    fn stall(&self, model: &Model, state: &mut State, alpha: f64) {
        let own = &self.p;
        if let Some([_, most]) = self.stall_limits
            && most != 0.0
        {
            let warning = if alpha > 0.85 * most { 10.0 * (alpha / most - 0.85) } else { 0.0 };
            state.write(model, own.stall_warning, warning);
        }
        if let Some([least, most]) = self.hysteresis_limits
            && least != 0.0
            && most != 0.0
        {
            if alpha > most {
                state.write(model, own.stall_hysteresis, 1.0);
            } else if alpha < least {
                state.write(model, own.stall_hysteresis, 0.0);
            }
        }
    }
}

fn limits(source: &Source, node: Node<'_, '_>) -> Result<[f64; 2], JsbsimError> {
    let unit = node.attribute("unit").map_or("RAD", str::trim);
    let factor = Unit::Radian
        .factor_from(unit)
        .ok_or_else(|| source.refuse(node, format!("the unit \"{}\" is not known", shortened(unit))))?;
    let least = source.child_number(node, "min")?.unwrap_or(0.0);
    let most = source.child_number(node, "max")?.unwrap_or(0.0);
    Ok([least * factor, most * factor])
}

fn total(model: &Model, state: &mut State, axes: &[Vec<usize>]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (sum, functions) in sums.iter_mut().zip(axes) {
        for &function in functions {
            *sum += state.call(model, function);
        }
    }
    sums
}

/// Sine and cosine of the angles of attack and sideslip.
#[derive(Debug, Clone, Copy)]
struct Turn([(f64, f64); 2]);

impl Turn {
    fn new(alpha: f64, beta: f64) -> Self {
        Self([alpha, beta].map(Scalar::sin_cos))
    }

    /// From axes of the wind to those of the body.
    fn of_wind(&self) -> [[f64; 3]; 3] {
        let [(sa, ca), (sb, cb)] = self.0;
        [[ca * cb, -ca * sb, -sa], [sb, cb, 0.0], [sa * cb, -sa * sb, ca]]
    }

    /// From stability axes to those of the body.
    fn of_stability(&self) -> [[f64; 3]; 3] {
        Self([self.0[0], (0.0, 1.0)]).of_wind()
    }
}

fn rotate(matrix: &[[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// One component of a vector in body axes along an axis of the wind.
fn transposed_row(matrix: &[[f64; 3]; 3], column: usize, vector: [f64; 3]) -> f64 {
    matrix.iter().zip(vector).map(|(row, value)| row[column] * value).sum()
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The vector product.
pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
