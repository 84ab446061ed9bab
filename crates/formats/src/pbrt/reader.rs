//! Converts files to a scene: it first reads all directives and builds meshes, then resolves names.

use super::directives;
use super::lexer::Lexer;
use super::media::Medium;
use super::options::Options;
use super::parameters::ParameterList;
use super::shapes::ShapeCache;
use super::spectra::Spectrum;
use super::state::{MaterialKey, Matrices, State};
use super::textures::NamedTextures;
use crate::FormatError;
use crate::oddities::Oddities;
use crate::reading::{Reading, Source};
use bilux_math::DMat4;
use bilux_scene::{Mesh, SceneBuilder, Span, Spec, Texture};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) fn read(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let working_folder = reading.options.working_folder.clone();
    let before = std::mem::replace(&mut reading.working_folder, working_folder);
    let scene = read_whole(reading, source);
    reading.working_folder = before;
    scene
}

fn read_whole(reading: &mut Reading, source: &Source) -> Result<SceneBuilder, FormatError> {
    let mut pbrt = Pbrt {
        reading,
        scene: SceneBuilder { describes_all_light: true, ..SceneBuilder::default() },
        oddities: Oddities::default(),
        folder: source.folder.map(Path::to_owned),
        state: State::new(),
        pushed: Vec::new(),
        in_world: false,
        systems: HashMap::new(),
        options: Options::default(),
        textures: NamedTextures::default(),
        materials: Vec::new(),
        named_materials: HashMap::new(),
        made_materials: HashMap::new(),
        mix_depth: 0,
        media: HashMap::new(),
        area_lights: Vec::new(),
        lights: Vec::new(),
        pieces: Vec::new(),
        definition: None,
        definitions: HashMap::new(),
        uses: Vec::new(),
        cache: ShapeCache::default(),
        open: Vec::new(),
        included: 0,
        spectra: HashMap::new(),
        placed_textures: HashMap::new(),
    };
    pbrt.whole(source)?;
    let Pbrt { mut scene, oddities, .. } = pbrt;
    oddities.into_warnings(&mut scene);
    Ok(scene)
}

/// An entity of a directive: its kind and parameters.
#[derive(Clone, Debug)]
pub(super) struct Entity {
    pub(super) kind: String,
    pub(super) parameters: ParameterList,
    pub(super) at: Span,
}

/// A shape of the scene, before its material is resolved.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) form: ShapeGeometry,
    /// The transforms to world space, or to the space of the object definition that contains it.
    pub(super) matrices: Matrices,
    pub(super) attributes: SurfaceAttributes,
    /// The number of shapes that pbrt counts, each of which emits the full power of its light.
    pub(super) shapes: u32,
    pub(super) at: Span,
}

/// The geometry of a shape.
#[derive(Clone, Debug)]
pub(super) enum ShapeGeometry {
    /// A triangle mesh.
    Mesh(Arc<Mesh>),
    /// A whole sphere around the origin; `reversed` turns it inside out.
    Sphere { radius: f32, reversed: bool },
}

/// The material and media of a shape.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct SurfaceAttributes {
    pub(super) material: MaterialKey,
    /// The index of its area light.
    pub(super) area_light: Option<usize>,
    pub(super) alpha: Alpha,
    pub(super) media: [Arc<str>; 2],
}

/// The opacity of a shape.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum Alpha {
    #[default]
    Whole,
    /// The bits of a number.
    Even(u32),
    /// The name of a texture.
    Texture(Arc<str>, u32, u32),
}

/// An instance of an object.
pub(super) struct ObjectInstance {
    pub(super) object: String,
    pub(super) matrices: Matrices,
    pub(super) at: Span,
}

/// The directive that pushed a graphics state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    Attribute,
    Transform,
    Object,
}

/// The state while a scene is read.
pub(super) struct Pbrt<'o, 'r> {
    pub(super) reading: &'r mut Reading<'o>,
    pub(super) scene: SceneBuilder,
    pub(super) oddities: Oddities,
    /// The folder of the first file, which all names are relative to.
    pub(super) folder: Option<PathBuf>,
    pub(super) state: State,
    pub(super) pushed: Vec<(Scope, Span, State)>,
    pub(super) in_world: bool,
    /// Named coordinate systems.
    pub(super) systems: HashMap<String, Matrices>,
    pub(super) options: Options,
    pub(super) textures: NamedTextures,
    pub(super) materials: Vec<Entity>,
    pub(super) named_materials: HashMap<Arc<str>, (usize, Span)>,
    /// Materials built so far.
    pub(super) made_materials: HashMap<MaterialKey, Option<Spec>>,
    /// The number of mixes around the material that is being built.
    pub(super) mix_depth: usize,
    pub(super) media: HashMap<Arc<str>, Medium>,
    pub(super) area_lights: Vec<Entity>,
    pub(super) lights: Vec<(Entity, DMat4)>,
    pub(super) pieces: Vec<Piece>,
    /// The object that is being defined.
    pub(super) definition: Option<(String, Vec<Piece>)>,
    pub(super) definitions: HashMap<String, Arc<Vec<Piece>>>,
    pub(super) uses: Vec<ObjectInstance>,
    pub(super) cache: ShapeCache,
    /// The chain of includes, from the first file to the current one.
    open: Vec<PathBuf>,
    /// The total bytes of included files, counted once per inclusion.
    included: u64,
    /// Spectra loaded from files.
    pub(super) spectra: HashMap<PathBuf, Arc<Spectrum>>,
    /// The indices of textures in the scene.
    pub(super) placed_textures: HashMap<*const Texture, usize>,
}

/// The cost of opening a file in addition to its bytes.
const MIN_FILE: u64 = 1 << 14;

/// Longer chains of includes are refused, since each level uses some of the stack.
const MAX_CHAIN: usize = 32;

impl Pbrt<'_, '_> {
    fn whole(&mut self, source: &Source) -> Result<(), FormatError> {
        let own = source.folder.zip(Path::new(&**source.name).file_name());
        let own = own.and_then(|(folder, file)| std::fs::canonicalize(folder.join(file)).ok());
        self.open.push(own.unwrap_or_default());
        let mut lexer = Lexer::new(source.name, source.bytes);
        directives::run(self, &mut lexer)?;
        if let Some((_, at, _)) = self.pushed.last() {
            let message =
                "what begins here is not closed before the file ends: add AttributeEnd or ObjectEnd";
            return Err(FormatError::malformed(message, at.clone()));
        }
        if let Some((name, _)) = &self.definition {
            let message = format!("the object '{name}' is not closed before the file ends: add ObjectEnd");
            return Err(FormatError::malformed(message, crate::text::whole_file(source.name)));
        }
        if !self.in_world {
            self.oddities.note(
                "it has no WorldBegin, so there is nothing to render: add WorldBegin before the \
                                shapes",
                || crate::text::whole_file(source.name),
            );
        }
        self.finish()
    }

    /// Reads another file at this point.
    pub(super) fn include(&mut self, name: &str, at: &Span) -> Result<(), FormatError> {
        let path = self.reading.locate_except(self.folder.as_deref(), name, &self.open, at)?;
        if self.open.contains(&path) {
            let message =
                format!("'{name}' includes itself, directly or through other files: remove it here");
            return Err(FormatError::malformed(message, at.clone()));
        }
        if self.open.len() >= MAX_CHAIN {
            let message = format!("files are included more than {MAX_CHAIN} levels deep");
            return Err(FormatError::malformed(message, at.clone()));
        }
        let raw = self.reading.load(&path)?;
        let unpacked = super::gzip::plain(raw, self.reading, &path, at)?;
        let bytes = self.reading.as_text(unpacked, &path)?;
        self.included = self.included.saturating_add(bytes.len() as u64 + MIN_FILE);
        if self.included > self.reading.options.max_memory {
            let message = "the includes multiply so much that reading would not end: remove some";
            return Err(FormatError::malformed(message, at.clone()));
        }
        let shown = Path::new(&*at.file).with_file_name(name).display().to_string().into();
        self.open.push(path);
        directives::run(self, &mut Lexer::new(&shown, &bytes))?;
        self.open.pop();
        self.reading.release(bytes);
        Ok(())
    }
}
