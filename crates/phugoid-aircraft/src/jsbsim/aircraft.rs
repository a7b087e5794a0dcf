//! An aircraft read from its file, and those that its file refers to.

use std::path::{Path, PathBuf};

use roxmltree::Node;

use super::aerodynamics::Aerodynamics;
use super::builtin;
use super::channels::Channels;
use super::error::{JsbsimError, Omission};
use super::fed::Fed;
use super::files::{Files, Kind};
use super::flight::FlightProperties;
use super::function;
use super::mass::{Geometry, MassProperties, Masses, Metrics};
use super::model::{Model, State};
use super::propulsion::{self, Engine};
use super::source::{Source, children, shortened, tag};
use crate::xml::{self, XmlError};

/// An aircraft of JSBSim. It does not change; an [`Evaluator`](super::Evaluator) holds what does.
#[derive(Debug, Clone)]
pub struct Aircraft {
    name: String,
    files: Vec<PathBuf>,
    pub(super) omitted: Vec<Omission>,
    pub(super) model: Model,
    pub(super) metrics: Metrics,
    pub(super) masses: Masses,
    pub(super) aerodynamics: Aerodynamics,
    pub(super) channels: Channels,
    pub(super) engines: Vec<Engine>,
    pub(super) flight: FlightProperties,
    pub(super) fed: Fed,
    /// Properties that are the same in every flight.
    pub(super) constants: Vec<usize>,
}

/// The sections that make an aircraft, as they are found.
struct Parts<'a> {
    model: &'a mut Model,
    files: &'a mut Files,
    omitted: &'a mut Vec<Omission>,
}

impl Aircraft {
    /// Reads the aircraft of a file, or of a folder `name` the one in `name/name.xml`.
    ///
    /// Systems are looked for in the folder of the file, in `Systems` below it and in `systems` two folders up; engines in
    /// `Engines` below it and in `engine` two folders up. No other folder is read.
    ///
    /// # Errors
    /// [`JsbsimError`]: a file that cannot be read, and the first element that cannot be understood or that would change the
    /// aerodynamics, with its line.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, JsbsimError> {
        let path = path.as_ref();
        let file = if path.is_dir() {
            let name = path.canonicalize().ok().and_then(|folder| folder.file_name().map(PathBuf::from));
            let mut name = name.unwrap_or_default().into_os_string();
            name.push(".xml");
            path.join(name)
        } else {
            path.to_path_buf()
        };
        let text = super::files::text_of(&file)?;
        Self::read(&text, &file, Files::of(&file))
    }

    /// Reads an aircraft from the text of its file. What it refers to is not looked for.
    ///
    /// # Errors
    /// [`JsbsimError`], as for [`Aircraft::open`]; its file is called `text`.
    pub fn from_text(text: &str) -> Result<Self, JsbsimError> {
        Self::read(text, Path::new("text"), Files::none())
    }

    fn read(text: &str, file: &Path, mut files: Files) -> Result<Self, JsbsimError> {
        if text.len() as u64 > xml::MAX_BYTES {
            return Err(JsbsimError::Unreadable(XmlError::TooLarge { file: file.into(), bytes: text.len() as u64 }));
        }
        let source = Source::new(file.into(), text);
        let document = xml::parse(text).map_err(|source| JsbsimError::Xml { file: file.into(), source })?;
        let root = document.root_element();
        if tag(root) != "fdm_config" {
            let what = format!("the file begins with <{}>, not with <fdm_config>", shortened(tag(root)));
            return Err(source.refuse(root, what));
        }
        let mut model = Model::default();
        let mut omitted = Vec::new();
        let flight = FlightProperties::new(&mut model);
        // JSBSim begins with the gear down.
        for name in ["gear/gear-cmd-norm", "gear/gear-pos-norm"] {
            let index = model.property(name);
            model.begin(index, 1.0);
        }
        let mut parts = Parts { model: &mut model, files: &mut files, omitted: &mut omitted };
        let sections = |name: &'static str| children(root).filter(move |part| tag(*part) == name);
        let single = |name: &'static str| sections(name).next();

        // In the order in which JSBSim reads them, whatever theirs in the file is.
        let missing = |what: &str| source.refuse(root, format!("the aircraft has no <{what}>"));
        let node = single("metrics").ok_or_else(|| missing("metrics"))?;
        let metrics = parts.section(&source, node, Kind::Section, |parts, source, node| {
            let metrics = Metrics::read(parts.model, source, node)?;
            parts.functions(source, node)?;
            Ok(metrics)
        })?;
        let mut masses = Masses::default();
        let node = single("mass_balance").ok_or_else(|| missing("mass_balance"))?;
        parts.section(&source, node, Kind::Section, |parts, source, node| {
            masses.read_balance(parts.model, source, node)?;
            parts.functions(source, node)
        })?;
        // Of these only the functions are kept, which others may read.
        for name in ["ground_reactions", "external_reactions", "buoyant_forces"] {
            for node in sections(name) {
                parts.section(&source, node, Kind::Section, |parts, source, node| parts.functions(source, node))?;
            }
        }
        let mut engines = Vec::new();
        if let Some(node) = single("propulsion") {
            engines = parts.section(&source, node, Kind::Section, |parts, source, node| {
                let engines = propulsion::read(parts.model, &mut masses, parts.files, source, node, parts.omitted)?;
                parts.functions(source, node)?;
                Ok(engines)
            })?;
        }
        let mut channels = Channels::default();
        for (name, kind) in [("system", Kind::System), ("autopilot", Kind::Section), ("flight_control", Kind::Section)]
        {
            for node in sections(name) {
                parts.system(&source, node, kind, &mut channels)?;
            }
        }
        channels.follow_engines(parts.model, engines.len());
        let node = single("aerodynamics").ok_or_else(|| missing("aerodynamics"))?;
        let aerodynamics = parts.section(&source, node, Kind::Section, |parts, source, node| {
            Aerodynamics::read(parts.model, source, node, parts.omitted)
        })?;
        for node in children(root) {
            let what = match tag(node) {
                "fileheader" | "metrics" | "mass_balance" | "propulsion" | "system" | "autopilot"
                | "flight_control" | "aerodynamics" | "documentation" | "output" | "input" => continue,
                "ground_reactions" => "the ground and the landing gear are left out",
                "external_reactions" => "forces from outside are left out",
                "buoyant_forces" => "buoyancy is left out, and so is the mass of gas",
                _ => "it is left out",
            };
            parts.omitted.push(source.omit(node, format!("<{}>: {what}", shortened(tag(node)))));
        }
        let complete = !files.is_missing();
        function::check_circles(&model)?;
        let constants = builtin::begin_constants(&mut model);
        let fed = Fed::new(&mut model, engines.len());
        let name = root.attribute("name").unwrap_or_default().trim().to_owned();
        let files = files.into_found();
        let mut read = Self {
            name,
            files,
            omitted,
            model,
            metrics,
            masses,
            aerodynamics,
            channels,
            engines,
            flight,
            fed,
            constants,
        };
        read.check_sources(complete)?;
        Ok(read)
    }

    /// The name that the file gives.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The files that it was read from, its own first, then those of systems and engines; none for a text.
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Its own file, for messages; `text` where it was read from a text.
    pub(crate) fn own_file(&self) -> PathBuf {
        self.files.first().cloned().unwrap_or_else(|| PathBuf::from("text"))
    }

    /// What the files ask for and this crate leaves out, in the order in which it was met.
    pub fn omitted(&self) -> &[Omission] {
        &self.omitted
    }

    /// Mass, centre and inertia with the fuel that the file puts in the tanks.
    pub fn mass_properties(&self) -> MassProperties {
        self.masses.properties(&self.model, &mut State::new(&self.model))
    }

    /// Sizes that coefficients refer to.
    pub fn geometry(&self) -> Geometry {
        self.metrics.geometry()
    }

    /// The engines in the order of the file.
    pub fn engines(&self) -> &[Engine] {
        &self.engines
    }

    /// Number of components of flight control.
    pub fn components(&self) -> usize {
        self.channels.len()
    }

    /// Names of all properties that the files mention or that this crate knows, in the order of their indices.
    pub fn properties(&self) -> impl ExactSizeIterator<Item = &str> {
        self.model.properties.iter().map(|property| property.name.as_str())
    }

    /// Index of a property, `None` where no file mentions it. `a[0]` and `a` are the same.
    pub fn property(&self, name: &str) -> Option<usize> {
        self.model.find(name)
    }

    /// The file and the line, from 1, that first name a property; none where no file does.
    pub(crate) fn mentioned(&self, name: &str) -> Option<(PathBuf, u32)> {
        self.model.properties[self.property(name)?].mentioned.clone()
    }

    /// Names of the properties that are written along with one: the angle of a surface in its other units.
    pub(crate) fn written_along(&self, index: usize) -> impl Iterator<Item = &str> {
        self.model.linked(index).map(|other| self.model.properties[other].name.as_str())
    }

    /// Indices of properties that functions or channels read and that neither a channel, a function, a `<property>` of the
    /// files nor a flight condition gives a value: what has to be set from outside. They are 0 until then.
    pub fn inputs(&self) -> Vec<usize> {
        let mut read = vec![false; self.model.properties.len()];
        for function in &self.model.functions {
            for op in &function.ops {
                if let function::Op::Property(index, _) = *op {
                    read[index] = true;
                }
            }
        }
        for lookup in &self.model.tables {
            for &(index, _) in lookup.variables.iter().flatten() {
                read[index] = true;
            }
        }
        for index in self.channels.inputs() {
            read[index] = true;
        }
        let mut along = vec![false; read.len()];
        for index in 0..read.len() {
            if self.model.properties[index].declared {
                self.model.linked(index).for_each(|other| along[other] = true);
            }
        }
        let property = |index: &usize| &self.model.properties[*index];
        let open = |index: &usize| {
            read[*index]
                && !along[*index]
                && !property(index).declared
                && property(index).function.is_none()
                && !self.flight.contain(*index)
                && !self.fed.contain(*index)
                && !self.constants.contains(index)
        };
        (0..read.len()).filter(open).collect()
    }

    /// Indices of properties that channels write.
    pub fn outputs(&self) -> Vec<usize> {
        let mut found: Vec<_> = self.channels.outputs().collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

impl Parts<'_> {
    /// Reads the properties and functions of a section that is about something else.
    fn functions(&mut self, source: &Source, node: Node<'_, '_>) -> Result<(), JsbsimError> {
        for part in children(node) {
            match tag(part) {
                "property" => super::declare(self.model, source, part)?,
                "function" => {
                    function::read(self.model, source, part)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads a section from where it stands, or from the file that it refers to.
    fn section<R>(
        &mut self,
        source: &Source,
        node: Node<'_, '_>,
        kind: Kind,
        read: impl FnOnce(&mut Self, &Source, Node<'_, '_>) -> Result<R, JsbsimError>,
    ) -> Result<R, JsbsimError> {
        let Some(name) = node.attribute("file").filter(|name| !name.trim().is_empty()) else {
            return read(self, source, node);
        };
        let (path, text) = self.files.text(source, node, name, kind)?;
        let inside = Source::new(path.clone(), &text);
        let document = xml::parse(&text).map_err(|source| JsbsimError::Xml { file: path, source })?;
        let root = document.root_element();
        if tag(root) != tag(node) {
            let what = format!("the file begins with <{}>, not with <{}>", shortened(tag(root)), tag(node));
            return Err(inside.refuse(root, what));
        }
        read(self, &inside, root)
    }

    /// Reads a system: that of its file first, then what stands in the element itself.
    fn system(
        &mut self,
        source: &Source,
        node: Node<'_, '_>,
        kind: Kind,
        channels: &mut Channels,
    ) -> Result<(), JsbsimError> {
        let refers = node.attribute("file").is_some_and(|name| !name.trim().is_empty());
        if !refers {
            Channels::read_properties(self.model, source, node)?;
            return channels.read(self.model, source, node, self.omitted);
        }
        let outer = source;
        let outer_node = node;
        let read = self.section(source, node, kind, |parts, source, root| {
            Channels::read_properties(parts.model, source, root)?;
            // Values in the element that refers to the file go before those in the file.
            Channels::read_properties(parts.model, outer, outer_node)?;
            channels.read(parts.model, outer, outer_node, parts.omitted)?;
            channels.read(parts.model, source, root, parts.omitted)
        });
        match read {
            // A system is not needed for the aerodynamics: without its file, the aircraft flies with what is set.
            Err(JsbsimError::Refused { what, file, .. }) if file == source.file && what.contains("no such file") => {
                self.omitted.push(source.omit(node, what));
                Ok(())
            }
            other => other,
        }
    }
}
