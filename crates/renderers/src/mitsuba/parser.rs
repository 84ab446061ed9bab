//! Turns elements into plugins and properties: variables, includes, ids, and the names of older versions.

use super::document::Document;
use super::plugin::{Plugin, Property, Value};
use super::transforms::{Placement, step};
use super::upgrade::{Version, complete, kind_of_version_3, name_of_version_3};
use super::values::{GivenColour, numbers_of, rgb, samples, spectrum};
use super::variables::Variables;
use bilux_import::FormatError;
use bilux_import::appearance::spectra::{Spectrum, planck};
use bilux_import::bytes::xml::Xml;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::includes::Includes;
use bilux_import::input::names::{shortened, unknown};
use bilux_import::input::reading::{Reading, Source};
use bilux_math::{DMat4, DVec3};
use bilux_scene::{SceneError, Span};
use roxmltree::Node;
use std::cell::Cell;
use std::path::Path;
use std::rc::Rc;
use std::sync::Arc;

/// Elements that are plugins, and what this reader calls them.
const PLUGINS: &[(&str, &str)] = &[
    ("bsdf", "bsdf"),
    ("shape", "shape"),
    ("emitter", "emitter"),
    ("luminaire", "emitter"),
    ("sensor", "sensor"),
    ("camera", "sensor"),
    ("film", "film"),
    ("sampler", "sampler"),
    ("rfilter", "rfilter"),
    ("integrator", "integrator"),
    ("texture", "texture"),
    ("spectrum", "spectrum"),
    ("medium", "medium"),
    ("phase", "phase"),
    ("volume", "volume"),
    ("subsurface", "subsurface"),
];

/// Elements that are values.
const VALUES: [&str; 16] = [
    "float",
    "integer",
    "boolean",
    "string",
    "vector",
    "point",
    "rgb",
    "srgb",
    "spectrum",
    "blackbody",
    "ref",
    "transform",
    "animation",
    "include",
    "default",
    "alias",
];

/// Deeper elements are refused, since each level uses some of the stack.
const MAX_DEPTH: usize = 64;

/// Reads elements.
pub(super) struct Parser<'p, 'o> {
    pub(super) reading: &'p mut Reading<'o>,
    pub(super) diagnostics: Diagnostics,
    pub(super) document: Document,
    pub(super) includes: Includes,
    pub(super) variables: Variables,
}

/// The file that is being read.
struct File<'f, 'a> {
    xml: &'f Xml<'a>,
    version: Version,
}

impl Parser<'_, '_> {
    /// Reads the first file, whose outermost element is the scene.
    pub(super) fn scene(&mut self, source: &Source) -> Result<(), FormatError> {
        let text = String::from_utf8_lossy(source.bytes);
        let xml = Xml::parse(&text, source.name, &mut self.reading.budget)?;
        let root = xml.root();
        if !root.has_tag_name("scene") {
            let message = format!(
                "a scene begins with <scene version=\"3.0.0\">, not <{}>",
                shortened(root.tag_name().name())
            );
            return Err(FormatError::malformed(message, xml.at(root)));
        }
        let file = File { version: Version::of(&root), xml: &xml };
        let parts = self.children(root, &file, 0)?;
        let parts = self.objects(parts)?;
        self.document.parts.extend(parts);
        Ok(())
    }

    /// The objects among the children of a scene.
    fn objects(&mut self, children: Vec<Property>) -> Result<Vec<Rc<Plugin>>, FormatError> {
        let mut objects = Vec::new();
        for child in children {
            match child.value {
                Value::Object(object) => objects.push(object),
                // What a scene refers to is in it already, or will be.
                Value::Reference(_) => {}
                _ => {
                    let what = format!("'{}' of the scene is not used", shortened(&child.name));
                    self.diagnostics.note(&what, || child.at);
                }
            }
        }
        Ok(objects)
    }

    /// The properties and parts within an element.
    fn children(&mut self, node: Node, file: &File, depth: usize) -> Result<Vec<Property>, FormatError> {
        if depth > MAX_DEPTH {
            let message = format!("elements are nested more than {MAX_DEPTH} levels deep");
            return Err(FormatError::malformed(message, file.xml.at(node)));
        }
        let mut properties = Vec::new();
        for child in node.children().filter(Node::is_element) {
            self.child(child, file, depth, &mut properties)?;
        }
        Ok(properties)
    }

    fn child(
        &mut self,
        node: Node,
        file: &File,
        depth: usize,
        into: &mut Vec<Property>,
    ) -> Result<(), FormatError> {
        let (word, at) = (node.tag_name().name(), file.xml.at(node));
        self.reading.budget.take::<Property>(1, &at.file)?;
        let value = match word {
            "default" => {
                let (name, value) = (self.needed(node, "name", file)?, self.needed(node, "value", file)?);
                self.variables.default(&name, value);
                return Ok(());
            }
            "path" => {
                let path = self.needed(node, "value", file)?;
                self.document.files.paths.push(path);
                return Ok(());
            }
            "alias" => return self.alias(node, file),
            "include" => return self.include(node, file, depth, into),
            _ => match PLUGINS.iter().find(|(name, _)| *name == word) {
                Some(_) if word == "spectrum" && !node.has_attribute("type") => {
                    Value::Colour(self.given_spectrum(node, file)?)
                }
                Some((_, tag)) => Value::Object(self.plugin(node, tag, file, depth)?),
                None => self.value(node, word, file)?,
            },
        };
        let name = self.attribute(node, "name", file)?.unwrap_or_default();
        let name = if file.version.is_old() { name_of_version_3(&name) } else { name };
        into.push(Property { name, value, at, used: Cell::new(false) });
        Ok(())
    }

    /// An object, which is also known by its id.
    fn plugin(
        &mut self,
        node: Node,
        tag: &'static str,
        file: &File,
        depth: usize,
    ) -> Result<Rc<Plugin>, FormatError> {
        let at = file.xml.at(node);
        let kind = self.needed(node, "type", file)?;
        let is_old = file.version.is_old();
        let id = self.attribute(node, "id", file)?.unwrap_or_default();
        let mut properties = self.children(node, file, depth + 1)?;
        if is_old {
            complete(tag, &kind, &mut properties, &self.document.ids, &at);
        }
        let kind = if is_old { kind_of_version_3(&kind) } else { &kind }.to_lowercase();
        let bytes = size_of::<Plugin>() + kind.len() + 3 * id.len();
        self.reading.budget.take_bytes(2 * bytes as u64, &at.file)?;
        let plugin = Rc::new(Plugin::new(tag, kind, id.clone(), properties, at.clone()));
        if !id.is_empty() && self.document.ids.insert(id.as_str().into(), plugin.clone()).is_some() {
            let message =
                format!("there is already an object with the id '{}': give this one another", shortened(&id));
            return Err(FormatError::malformed(message, at));
        }
        Ok(plugin)
    }

    fn alias(&mut self, node: Node, file: &File) -> Result<(), FormatError> {
        let (id, other) = (self.needed(node, "id", file)?, self.needed(node, "as", file)?);
        let ids = &mut self.document.ids;
        let Some(object) = ids.get(id.as_str()).cloned() else {
            return Err(unknown("id", &id, ids.keys().map(|id| &**id), &file.xml.at(node)));
        };
        ids.insert(other.as_str().into(), object);
        Ok(())
    }

    /// Reads another file in place of this element.
    fn include(
        &mut self,
        node: Node,
        file: &File,
        depth: usize,
        into: &mut Vec<Property>,
    ) -> Result<(), FormatError> {
        let (name, at) = (self.needed(node, "filename", file)?, file.xml.at(node));
        let (_, name) = self.document.files.locate(&name, &at, self.reading)?;
        let folder = self.document.files.folder.clone();
        let included = self.includes.open(&name, &at, folder.as_deref(), self.reading)?;
        let text = String::from_utf8_lossy(&included.bytes).into_owned();
        let shown: Arc<str> = included.name.clone();
        let xml = Xml::parse(&text, &shown, &mut self.reading.budget)?;
        let root = xml.root();
        let inner = File { version: Version::of(&root), xml: &xml };
        if root.has_tag_name("scene") {
            into.extend(self.children(root, &inner, depth + 1)?);
        } else {
            self.child(root, &inner, depth + 1, into)?;
        }
        drop(xml);
        self.includes.close(included, self.reading);
        Ok(())
    }

    /// An attribute, with its variables replaced.
    fn attribute(&mut self, node: Node, name: &str, file: &File) -> Result<Option<String>, FormatError> {
        match node.attribute(name) {
            Some(text) => self.variables.replaced(text, &|| file.xml.at(node)).map(Some),
            None => Ok(None),
        }
    }

    /// An attribute that must be given.
    fn needed(&mut self, node: Node, name: &str, file: &File) -> Result<String, FormatError> {
        self.attribute(node, name, file)?.ok_or_else(|| {
            let what = format!("{name} (of <{}>)", node.tag_name().name());
            SceneError::Missing { what, at: file.xml.at(node) }.into()
        })
    }

    fn value(&mut self, node: Node, word: &str, file: &File) -> Result<Value, FormatError> {
        let at = file.xml.at(node);
        let name = node.attribute("name").unwrap_or(word);
        let wrong = |wanted: &str, text: &str| {
            let message = format!("'{}' must be {wanted}, not '{}'", shortened(name), shortened(text));
            Err(FormatError::malformed(message, at.clone()))
        };
        Ok(match word {
            "float" => {
                let [number] = numbers_of(&self.needed(node, "value", file)?, name, &at)?;
                Value::Number(number)
            }
            "integer" => {
                let text = self.needed(node, "value", file)?;
                match text.trim().parse() {
                    Ok(number) => Value::Integer(number),
                    Err(_) => return wrong("a whole number", &text),
                }
            }
            // Of any case, as Mitsuba has it: Python writes True.
            "boolean" => match &*self.needed(node, "value", file)?.trim().to_lowercase() {
                "true" => Value::Flag(true),
                "false" => Value::Flag(false),
                other => return wrong("true or false", other),
            },
            "string" => {
                let text = self.needed(node, "value", file)?;
                self.reading.budget.take_bytes(text.len() as u64, &at.file)?;
                Value::Text(text)
            }
            "vector" | "point" => Value::Vector(self.vector(node, file)?),
            "rgb" | "srgb" => {
                let text = self.needed(node, "value", file)?;
                // In version 0.5, `srgb` has the curve of the standard.
                Value::Colour(GivenColour::Rgb(rgb(
                    &text,
                    name,
                    word == "srgb" && file.version.is_old(),
                    &at,
                )?))
            }
            "blackbody" => {
                let text = self.needed(node, "temperature", file)?;
                let [kelvin] = numbers_of::<1>(text.trim().trim_end_matches(['K', 'k']), name, &at)?;
                let scale = self.attribute(node, "scale", file)?.unwrap_or_else(|| "1".to_owned());
                let [scale] = numbers_of::<1>(&scale, name, &at)?;
                Value::Colour(GivenColour::Samples(Arc::new(black_body(kelvin, scale))))
            }
            "ref" => Value::Reference(self.needed(node, "id", file)?.into()),
            "transform" => Value::Transform(Arc::new(Placement(vec![(0.0, self.matrix(node, file)?)]))),
            "animation" => Value::Transform(Arc::new(self.animation(node, file)?)),
            _ => {
                let known = PLUGINS.iter().map(|(name, _)| *name).chain(VALUES);
                return Err(unknown("element", word, known, &at));
            }
        })
    }

    /// Three numbers, each in an attribute or all in one.
    fn vector(&mut self, node: Node, file: &File) -> Result<DVec3, FormatError> {
        let at = file.xml.at(node);
        if let Some(text) = self.attribute(node, "value", file)? {
            return numbers_of::<3>(&text, "value", &at).map(DVec3::from);
        }
        let mut vector = DVec3::ZERO;
        for (i, name) in ["x", "y", "z"].into_iter().enumerate() {
            if let Some(text) = self.attribute(node, name, file)? {
                [vector[i]] = numbers_of::<1>(&text, name, &at)?;
            }
        }
        Ok(vector)
    }

    /// The steps of a transform, the first of which is applied first.
    fn matrix(&mut self, node: Node, file: &File) -> Result<DMat4, FormatError> {
        let mut matrix = DMat4::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            let (word, at) = (child.tag_name().name(), file.xml.at(child));
            let (variables, place) = (std::cell::RefCell::new(&mut self.variables), at.clone());
            let attribute = |name: &str| {
                let text = child.attribute(name);
                text.map(|text| variables.borrow_mut().replaced(text, &|| place.clone())).transpose()
            };
            match step(word, &attribute, file.version.is_old(), &at)? {
                Some(step) => matrix = step * matrix,
                None => {
                    let known = ["translate", "rotate", "scale", "matrix", "lookat"];
                    return Err(unknown("step of a transform", word, known, &at));
                }
            }
        }
        Ok(matrix)
    }

    /// Transforms at several times.
    fn animation(&mut self, node: Node, file: &File) -> Result<Placement, FormatError> {
        let mut keys: Vec<(f64, DMat4)> = Vec::new();
        for child in node.children().filter(|child| child.has_tag_name("transform")) {
            let at = file.xml.at(child);
            let [time] = numbers_of::<1>(&self.needed(child, "time", file)?, "time", &at)?;
            if !time.is_finite() || keys.last().is_some_and(|(last, _)| *last >= time) {
                return Err(FormatError::malformed("the times of an animation must increase", at));
            }
            self.reading.budget.take::<(f64, DMat4)>(1, &at.file)?;
            keys.push((time, self.matrix(child, file)?));
        }
        if keys.is_empty() {
            return Err(FormatError::malformed(
                "an animation needs transforms with times",
                file.xml.at(node),
            ));
        }
        Ok(Placement(keys))
    }

    /// A spectrum without a type: numbers, or a file of them.
    fn given_spectrum(&mut self, node: Node, file: &File) -> Result<GivenColour, FormatError> {
        let (at, name) = (file.xml.at(node), node.attribute("name").unwrap_or("spectrum").to_owned());
        let text = match self.attribute(node, "filename", file)? {
            Some(file) => return self.spectrum_file(&file, &name, &at),
            None => self.needed(node, "value", file)?,
        };
        self.reading.budget.take_bytes(4 * text.len() as u64, &at.file)?;
        spectrum(&text, &name, &at)
    }

    /// A file of lines with a wavelength and a number.
    fn spectrum_file(&mut self, file: &str, name: &str, at: &Span) -> Result<GivenColour, FormatError> {
        let (path, _) = self.document.files.locate(file, at, self.reading)?;
        let bytes = self.reading.load_text(&path)?;
        self.reading.budget.take_bytes(4 * bytes.len() as u64, name)?;
        let text = String::from_utf8_lossy(&bytes);
        let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim());
        let pairs = lines.filter(|line| !line.is_empty()).map(|line| numbers_of::<2>(line, name, at));
        let pairs = pairs.collect::<Result<_, FormatError>>()?;
        drop(text);
        self.reading.release(bytes);
        samples(pairs, name, at)
    }
}

/// The light of a black body in W/(m² sr nm).
pub(super) fn black_body(kelvin: f64, scale: f64) -> Spectrum {
    Spectrum((0..=94).map(|i| f64::from(360 + 5 * i)).map(|nm| [nm, scale * planck(nm, kelvin)]).collect())
}

/// The file of a scene, if it has one.
pub(super) fn own_file(source: &Source) -> Option<std::path::PathBuf> {
    let own = source.folder.zip(Path::new(&**source.name).file_name());
    own.and_then(|(folder, file)| std::fs::canonicalize(folder.join(file)).ok())
}
