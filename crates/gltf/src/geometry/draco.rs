//! `KHR_draco_mesh_compression`: primitives whose attributes and indices are compressed together. The decoded data
//! replaces that of their accessors.

use crate::document::json::JsonNode;
use crate::document::json_document::{DecodedAccessor, Document};
use crate::geometry::topology::Mode;
use bilux_import::FormatError;
use bilux_import::bytes::budget::Budget;
use bilux_pictures::guarded_decoding;
use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder, PointAttribute, PointIndex,
};
use std::collections::HashMap;

pub(crate) const NAME: &str = "KHR_draco_mesh_compression";

/// Upper bounds on the decoder's tables in addition to its output, in bytes per triangle and per corner.
const BYTES_PER_FACE: u64 = 256;
const BYTES_PER_POINT: u64 = 64;

/// The data of all accessors of compressed primitives, by accessor index.
pub(crate) fn unpack(
    document: &Document,
    budget: &mut Budget,
) -> Result<HashMap<usize, DecodedAccessor>, FormatError> {
    let mut drawn = HashMap::new();
    for mesh in document.root.list("meshes")? {
        for primitive in mesh.list("primitives")? {
            let Some(extension) = primitive.extension(NAME) else { continue };
            if Mode::of(primitive)? != Mode::Triangles {
                return Err(primitive.error("Draco compresses only triangles: mode must be 4"));
            }
            let wanted = wanted(primitive, extension)?;
            if wanted.iter().all(|(number, _)| drawn.contains_key(number)) {
                continue;
            }
            let mesh = decoded(document, extension, budget)?;
            for (number, attribute) in wanted {
                let of_accessor = of_accessor(document, number, attribute, &mesh, extension)?;
                budget.take_bytes(of_accessor.bytes.len() as u64, &extension.at().file)?;
                drawn.insert(number, of_accessor);
            }
        }
    }
    Ok(drawn)
}

/// The accessors of a primitive and the attributes that fill them; no attribute fills the indices.
fn wanted<'d>(
    primitive: JsonNode<'d>,
    extension: JsonNode<'d>,
) -> Result<Vec<(usize, Option<JsonNode<'d>>)>, FormatError> {
    let attributes = primitive.need("attributes")?;
    let mut wanted = Vec::new();
    for (name, attribute) in extension.need("attributes")?.entries() {
        let accessor = attributes.get(name);
        let accessor = accessor.ok_or_else(|| attribute.error("the primitive has no such attribute"))?;
        wanted.push((accessor.as_count()?, Some(attribute)));
    }
    if let Some(indices) = primitive.get("indices") {
        wanted.push((indices.as_count()?, None));
    }
    Ok(wanted)
}

fn decoded(document: &Document, extension: JsonNode, budget: &mut Budget) -> Result<Mesh, FormatError> {
    let bytes = document.view(extension.need("bufferView")?)?.bytes;
    let left = budget.left();
    let limits = DecodeLimits::default()
        .with_max_faces(left / BYTES_PER_FACE)
        .with_max_points(left / BYTES_PER_POINT)
        .with_max_decoded_bytes(left / 4);
    let decode = || {
        let mut mesh = Mesh::new();
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        MeshDecoder::new().decode(&mut buffer, &mut mesh).map(|()| mesh)
    };
    let broken = |what: &str| {
        extension.error(format!(
            "the Draco data of this primitive cannot be decompressed: {what}; export the file again"
        ))
    };
    match guarded_decoding(decode) {
        None => Err(broken("they contradict each other")),
        Some(Err(error)) if error.kind() == ErrorKind::LimitExceeded => {
            budget.take_bytes(u64::MAX, &extension.at().file)?;
            Err(broken(fault(error.kind())))
        }
        Some(Err(error)) => Err(broken(fault(error.kind()))),
        Some(Ok(mesh)) => {
            // Never given back, although it is freed soon: this bounds how often a short file can demand it.
            budget.take_bytes(mesh.num_faces() as u64 * 12, &extension.at().file)?;
            Ok(mesh)
        }
    }
}

/// Describes a kind of decoder error.
fn fault(kind: ErrorKind) -> &'static str {
    match kind {
        ErrorKind::LimitExceeded => "they need more memory than is allowed",
        ErrorKind::UnsupportedFeature | ErrorKind::UnsupportedVersion => {
            "they use an unknown kind of compression"
        }
        _ => "they are damaged",
    }
}

/// The data of an accessor: an attribute of all points, or the corners of all triangles.
fn of_accessor(
    document: &Document,
    number: usize,
    attribute: Option<JsonNode>,
    mesh: &Mesh,
    extension: JsonNode,
) -> Result<DecodedAccessor, FormatError> {
    let accessor = document.root.item("accessors", number);
    let accessor = accessor.ok_or_else(|| extension.error(format!("there is no accessor {number}")))?;
    let component = accessor.need("componentType")?;
    let kind = component.as_count()?;
    let Some(attribute) = attribute else {
        let corners = mesh.faces().iter().flatten().map(|corner| corner.0);
        let fits = |most: u32| corners.clone().all(|corner| corner <= most);
        let bytes = match kind {
            5121 if fits(0xff) => corners.map(|corner| corner as u8).collect(),
            5123 if fits(0xffff) => corners.flat_map(|corner| (corner as u16).to_le_bytes()).collect(),
            5125 => corners.flat_map(u32::to_le_bytes).collect(),
            _ => return Err(component.error("the compressed indices do not fit this componentType")),
        };
        return Ok(DecodedAccessor { bytes, count: mesh.num_faces() * 3 });
    };
    let number = attribute.as_count()?;
    let packed = u32::try_from(number).ok().and_then(|id| mesh.attribute_by_unique_id(id));
    let packed =
        packed.ok_or_else(|| attribute.error(format!("the compressed data have no attribute {number}")))?;
    let count = mesh.num_points();
    let bytes = if component_of(packed.data_type()) == Some(kind) {
        raw(packed, count).ok_or_else(|| attribute.error("this attribute has fewer values than points"))?
    } else if kind == 5126 {
        let numbers = packed.read_f32s(count, packed.num_components().into());
        numbers.into_iter().flat_map(f32::to_le_bytes).collect()
    } else {
        return Err(component.error("the compressed attribute has another componentType"));
    };
    Ok(DecodedAccessor { bytes, count })
}

/// The raw values of all points, in order.
fn raw(packed: &PointAttribute, count: usize) -> Option<Vec<u8>> {
    let size = packed.data_type().byte_length() * usize::from(packed.num_components());
    let stride = usize::try_from(packed.byte_stride()).ok()?;
    let data = packed.buffer().data();
    let mut bytes = Vec::with_capacity(size * count);
    for point in 0..count as u32 {
        let start = (packed.mapped_index(PointIndex(point)).0 as usize).checked_mul(stride)?;
        bytes.extend_from_slice(data.get(start..start.checked_add(size)?)?);
    }
    Some(bytes)
}

fn component_of(kind: DataType) -> Option<usize> {
    Some(match kind {
        DataType::Int8 => 5120,
        DataType::Uint8 => 5121,
        DataType::Int16 => 5122,
        DataType::Uint16 => 5123,
        DataType::Uint32 => 5125,
        DataType::Float32 => 5126,
        _ => return None,
    })
}
