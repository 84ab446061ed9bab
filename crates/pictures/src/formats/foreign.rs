//! Formats that Bilux does not read, by their first bytes: a file of one of them, whatever its name, gets an answer that
//! helps.

/// One format that is not read.
#[derive(Clone, Copy, Debug)]
pub struct ForeignFormat {
    /// Kind of a file in the format, such as `a GIF picture`.
    pub what: &'static str,
    /// Advice on using such a file.
    pub advice: &'static str,
    /// Whether it holds a picture.
    pub is_picture: bool,
    /// True when a file begins like this.
    is_like: fn(&[u8]) -> bool,
}

const TO_PNG: &str =
    "convert it to PNG or JPEG with another program (such as ImageMagick: magick IN OUT.png)";
const RUNS: &str = "it is run, not read: name a file that holds what you mean";
const TO_GLB: &str = "export it as .glb from the program that made it, or from Blender";

const fn picture(what: &'static str, is_like: fn(&[u8]) -> bool) -> ForeignFormat {
    ForeignFormat { what, advice: TO_PNG, is_picture: true, is_like }
}

const fn scene(what: &'static str, is_like: fn(&[u8]) -> bool) -> ForeignFormat {
    ForeignFormat { what, advice: TO_GLB, is_picture: false, is_like }
}

const fn other(what: &'static str, advice: &'static str, is_like: fn(&[u8]) -> bool) -> ForeignFormat {
    ForeignFormat { what, advice, is_picture: false, is_like }
}

/// The formats that are recognised, the most specific first.
pub static FOREIGN_FORMATS: &[ForeignFormat] = &[
    picture("a GIF picture", |b| b.starts_with(b"GIF87a") || b.starts_with(b"GIF89a")),
    picture("an AVIF picture", |b| has_brand(b, &[b"avif", b"avis"])),
    picture("a HEIC picture, as phones take them", |b| {
        has_brand(b, &[b"heic", b"heix", b"hevc", b"heim", b"heis", b"mif1", b"msf1"])
    }),
    picture("a JPEG XL picture", |b| {
        b.starts_with(b"\xff\x0a") || b.starts_with(b"\0\0\0\x0cJXL \r\n\x87\n")
    }),
    picture("a JPEG 2000 picture", |b| {
        b.starts_with(b"\0\0\0\x0cjP  \r\n\x87\n") || b.starts_with(b"\xff\x4f\xff\x51")
    }),
    picture("a DDS picture, a texture of games", |b| b.starts_with(b"DDS ")),
    picture("a KTX 1 picture, a texture of games", |b| b.starts_with(b"\xabKTX 11\xbb\r\n\x1a\n")),
    picture("a KTX 2 picture, which this build does not read", |b| {
        b.starts_with(b"\xabKTX 20\xbb\r\n\x1a\n")
    }),
    picture("a Photoshop document (PSD)", |b| b.starts_with(b"8BPS")),
    picture("a GIMP document (XCF)", |b| b.starts_with(b"gimp xcf")),
    picture("a QOI picture", |b| b.starts_with(b"qoif")),
    picture("an icon (ICO)", |b| b.starts_with(b"\0\0\x01\0") && b.get(5) == Some(&0) && b.len() > 22),
    // A page may have drawings in it.
    other("a web page (HTML)", "download the file itself", |b| {
        has_root(b, b"<!DOCTYPE html") || has_root(b, b"<html")
    }),
    picture("an SVG drawing", |b| has_root(b, b"<svg")),
    picture("a PDF document", |b| b.starts_with(b"%PDF-")),
    picture("a Radiance XYZE picture", |b| b.starts_with(b"#?XYZE")),
    other("a glTF scene (GLB)", "give it a name that ends in .glb", |b| b.starts_with(b"glTF")),
    other("a PLY model", "give it a name that ends in .ply", |b| {
        b.starts_with(b"ply\n") || b.starts_with(b"ply\r")
    }),
    other("an FBX scene", "give it a name that ends in .fbx", |b| {
        b.starts_with(b"Kaydara FBX Binary") || b.starts_with(b"; FBX ")
    }),
    other("a USD scene", "give it a name that ends in .usd", |b| {
        b.starts_with(b"#usda ") || b.starts_with(b"PXR-USDC")
    }),
    other("a USDZ scene", "give it a name that ends in .usdz", |b| {
        is_zip_of(b, &[b".usdc", b".usda", b".usd"])
    }),
    other("a 3MF model", "give it a name that ends in .3mf", |b| {
        is_zip_of(b, &[b"[Content_Types].xml", b"3D/", b"_rels/"])
    }),
    scene("a Blender file", |b| b.starts_with(b"BLENDER")),
    other("a COLLADA scene", "give it a name that ends in .dae", |b| has_root(b, b"<COLLADA")),
    scene("an X3D scene", |b| has_root(b, b"<X3D")),
    scene("an AMF model", |b| has_root(b, b"<amf")),
    other("a Mitsuba scene", "give it a name that ends in .xml", |b| has_root(b, b"<scene")),
    scene("a VRML scene", |b| b.starts_with(b"#VRML")),
    other("a STEP model", "give it a name that ends in .step", |b| b.starts_with(b"ISO-10303-21")),
    scene("a 3D Studio scene (3DS)", |b| b.starts_with(b"MM") && b.get(6..8) == Some(b"\x02\0")),
    scene("an Alembic scene", |b| b.starts_with(b"Ogawa")),
    scene("a LightWave object", |b| {
        b.starts_with(b"FORM") && matches!(b.get(8..12), Some(b"LWO2" | b"LWOB" | b"LWO3"))
    }),
    scene("a Maya scene", |b| {
        b.starts_with(b"//Maya ASCII") || b.starts_with(b"FOR4") || b.starts_with(b"FOR8")
    }),
    scene("a Rhino model (3DM)", |b| b.starts_with(b"3D Geometry File Format ")),
    scene("a Draco mesh without a glTF around it", |b| b.starts_with(b"DRACO")),
    scene("a glTF of 3D Tiles (B3DM)", |b| b.starts_with(b"b3dm")),
    scene("a MagicaVoxel model", |b| b.starts_with(b"VOX ")),
    scene("an AutoCAD drawing (DWG)", |b| {
        b.starts_with(b"AC10") && b.get(4..6).is_some_and(|v| v.iter().all(u8::is_ascii_digit))
    }),
    scene("an IGES model of a CAD program", |b| {
        b.get(72..80) == Some(b"S      1") || b.get(72..80) == Some(b"S0000001")
    }),
    other("a program", RUNS, |b| {
        // Of Linux, of Windows and of macOS.
        b.starts_with(b"\x7fELF")
            || b.starts_with(b"MZ") && b.len() > 64
            || [&b"\xcf\xfa\xed\xfe"[..], b"\xce\xfa\xed\xfe", b"\xca\xfe\xba\xbe"]
                .iter()
                .any(|m| b.starts_with(m))
    }),
    other("a pointer of Git LFS", "fetch the file with `git lfs pull`", |b| {
        b.starts_with(b"version https://git-lfs.github.com/spec/")
    }),
    other("a zip archive", "give it a name that ends in .zip", |b| b.starts_with(b"PK\x03\x04")),
    other("a compressed archive (7z)", "unpack it, and name the file in it", |b| {
        b.starts_with(b"7z\xbc\xaf\x27\x1c")
    }),
    other("a compressed archive (rar)", "unpack it, and name the file in it", |b| {
        b.starts_with(b"Rar!\x1a\x07")
    }),
    other("a file compressed by gzip", "unpack it with `gzip -d`", |b| b.starts_with(b"\x1f\x8b\x08")),
    other(
        "a file compressed by zstd, such as a Blender file",
        "unpack it with `zstd -d`; export a Blender file as .glb",
        |b| b.starts_with(b"\x28\xb5\x2f\xfd"),
    ),
    other("a file compressed by xz", "unpack it with `xz -d`", |b| b.starts_with(b"\xfd7zXZ\0")),
];

/// The format of these bytes, if it is one that Bilux does not read.
pub fn foreign_format(bytes: &[u8]) -> Option<&'static ForeignFormat> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    FOREIGN_FORMATS.iter().find(|row| (row.is_like)(bytes))
}

/// True for the container of MPEG-4 with one of these brands.
fn has_brand(bytes: &[u8], brands: &[&[u8; 4]]) -> bool {
    bytes.get(4..8) == Some(b"ftyp")
        && bytes.get(8..12).is_some_and(|brand| brands.iter().any(|b| *b == brand))
}

/// True for XML or HTML with this element near its beginning.
fn has_root(bytes: &[u8], root: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(2048)];
    let begins = head.trim_ascii_start().starts_with(b"<");
    let is_root = |window: &[u8]| window.eq_ignore_ascii_case(root);
    let found = head.windows(root.len()).position(is_root);
    begins && found.is_some_and(|at| !head.get(at + root.len()).is_some_and(u8::is_ascii_alphanumeric))
}

/// True for a zip archive whose first file has one of these in its name.
fn is_zip_of(bytes: &[u8], parts: &[&[u8]]) -> bool {
    if !bytes.starts_with(b"PK\x03\x04") {
        return false;
    }
    let length = bytes.get(26..28).map_or(0, |l| usize::from(u16::from_le_bytes([l[0], l[1]])));
    let name = bytes.get(30..30 + length).unwrap_or_default();
    parts.iter().any(|part| name.windows(part.len()).any(|window| window == *part))
}
