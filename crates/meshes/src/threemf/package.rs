//! The parts of a package: their names, what they are, and how they refer to each other. [ISO 29500-2]

use super::xml::{Level, Xml};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::{Reading, Source};
use bilux_scene::Span;
use std::collections::HashMap;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const MODEL: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
const PRINT_TICKET: &str = "http://schemas.microsoft.com/3dmanufacturing/2013/01/printticket";
const ENCRYPTED: &str = "http://schemas.openxmlformats.org/package/2006/relationships/encryptedfile";
const MODEL_TYPE: &str = "application/vnd.ms-package.3dmanufacturing-3dmodel+xml";
const TYPES: &str = "[Content_Types].xml";
const RELATIONSHIPS: &str = "_rels/.rels";
/// Usual place of the model.
const USUAL: &str = "3D/3dmodel.model";

/// The first and last bytes that tell a package from other zip files.
const HEAD: usize = 1 << 16;

/// True for a zip file with the content types of a package, or with a model.
pub(super) fn is_package(bytes: &[u8]) -> bool {
    let has = |part: &[u8], name: &[u8]| part.windows(name.len()).any(|word| word.eq_ignore_ascii_case(name));
    let (first, last) = (&bytes[..bytes.len().min(HEAD)], &bytes[bytes.len().saturating_sub(HEAD)..]);
    let is_there = |name: &[u8]| has(first, name) || has(last, name);
    bytes.starts_with(b"PK\x03\x04") && (is_there(b".model") || is_there(TYPES.as_bytes()))
}

/// A package that is open.
pub(super) struct Package {
    /// The path that its members lie below.
    root: PathBuf,
    name: Arc<str>,
    /// The names of its members by their names in lower case: parts differ in more than that.
    members: HashMap<String, String>,
}

/// A reference from a part, or from the package, to another part.
struct Relationship {
    kind: String,
    target: String,
    at: Span,
}

impl Package {
    /// The package that the source is.
    pub(super) fn of(reading: &Reading, source: &Source) -> Result<Package, FormatError> {
        let root = source.folder.unwrap_or(Path::new("")).to_owned();
        let members = reading.locator.archives.at(&root).map_or(&[][..], |archive| archive.members());
        let members =
            members.iter().map(|member| (member.name.to_lowercase(), member.name.clone())).collect();
        let package = Package { root, name: source.name.clone(), members };
        if package.member(TYPES).is_none() && package.members_ending(".model").is_empty() {
            let message =
                format!("it has neither '{TYPES}' nor a model, so it is not a 3MF but some other archive");
            return Err(FormatError::malformed(message, whole_file(source.name)));
        }
        Ok(package)
    }

    /// The name in the archive of a part, whose name may begin with `/`; `None` if there is no such part.
    pub(super) fn member(&self, part: &str) -> Option<&str> {
        let name = part.trim_start_matches('/').to_lowercase();
        let found = self.members.get(&name).or_else(|| self.members.get(&percent_decoded(&name)?));
        found.map(String::as_str)
    }

    /// The members whose names end so, in the order of their names.
    pub(super) fn members_ending(&self, end: &str) -> Vec<String> {
        let mut found: Vec<String> = self
            .members
            .iter()
            .filter(|(name, _)| name.ends_with(end))
            .map(|(_, name)| name.clone())
            .collect();
        found.sort();
        found
    }

    /// Name of a part in messages.
    pub(super) fn named(&self, part: &str) -> Arc<str> {
        format!("{}/{}", self.name, part.trim_start_matches('/')).into()
    }

    /// A stream of a member.
    pub(super) fn stream(&self, reading: &mut Reading, member: &str) -> Result<Box<dyn Read>, FormatError> {
        let (stream, _) = reading.open_file(&self.root.join(member))?;
        Ok(stream)
    }

    /// Path of a member, for [`Reading::load`].
    pub(super) fn path(&self, member: &str) -> PathBuf {
        self.root.join(member)
    }

    /// The elements of a member.
    pub(super) fn xml(&self, reading: &mut Reading, member: &str) -> Result<Xml, FormatError> {
        let mut stream = self.stream(reading, member)?;
        let mut head = [0; 4];
        let mut count = 0;
        while count < head.len() {
            let failed = |source| FormatError::Io { path: self.root.join(member), action: "read it", source };
            match stream.read(&mut head[count..]).map_err(failed)? {
                0 => break,
                more => count += more,
            }
        }
        let head = head[..count].to_vec();
        // UTF-16 begins with a mark, or with a zero before or after `<`.
        let is_wide = matches!(head[..], [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [b'<', 0, ..] | [0, b'<', ..]);
        if is_wide {
            let text = reading.load_text(&self.root.join(member))?;
            return Ok(Xml::new(Box::new(io::Cursor::new(text)), self.named(member)));
        }
        Ok(Xml::new(Box::new(io::Cursor::new(head).chain(stream)), self.named(member)))
    }

    /// The part with the model that is to be printed.
    pub(super) fn model_part(
        &self,
        reading: &mut Reading,
        diagnostics: &mut Diagnostics,
    ) -> Result<String, FormatError> {
        let all = self.relationships(reading, RELATIONSHIPS)?;
        let whole = || whole_file(&self.named(RELATIONSHIPS));
        if let Some(secret) = all.iter().find(|relationship| relationship.kind == ENCRYPTED) {
            let message = format!(
                "'{}' is encrypted (the secure content extension), and cannot be read: export it without protection",
                secret.target
            );
            return Err(FormatError::malformed(message, secret.at.clone()));
        }
        let mut models = all.iter().filter(|relationship| relationship.kind == MODEL);
        let Some(model) = models.next() else {
            // Slicers look for it where it usually is.
            let found = self.member(USUAL).map(str::to_owned);
            let Some(member) = found.or_else(|| self.members_ending(".model").into_iter().next()) else {
                let message = "no relationship names the part with the 3D model: export the file again";
                return Err(FormatError::malformed(message, whole()));
            };
            let what = format!("no relationship names the part with the 3D model: '{member}' is taken");
            diagnostics.note(&what, whole);
            return Ok(member);
        };
        if let Some(second) = models.next() {
            let message = "a second relationship names a part with a 3D model: a file has one";
            return Err(FormatError::malformed(message, second.at.clone()));
        }
        let part = resolved("", &model.target);
        let Some(member) = self.member(&part) else {
            let message = format!("the 3D model is to be the part '{part}', which the file does not contain");
            return Err(FormatError::malformed(message, model.at.clone()));
        };
        match self.member(TYPES) {
            Some(_) => self.check_type(reading, member, &model.at)?,
            None => {
                let what = format!("the file has no '{TYPES}', which says what its parts are");
                diagnostics.note(&what, || whole_file(&self.name));
            }
        }
        self.check_targets(reading, "", &all, diagnostics)?;
        let of_model = self.relationships(reading, &relationships_of(member))?;
        self.check_targets(reading, member, &of_model, diagnostics)?;
        Ok(member.to_owned())
    }

    /// Checks that parts are there that others refer to, and that they are parts of this file.
    fn check_targets(
        &self,
        _: &Reading,
        from: &str,
        all: &[Relationship],
        diagnostics: &mut Diagnostics,
    ) -> Result<(), FormatError> {
        for relationship in all {
            let target = &relationship.target;
            if target.contains(':') {
                let message = format!(
                    "a relationship leads out of the file, to '{target}': export it with all parts in it"
                );
                return Err(FormatError::malformed(message, relationship.at.clone()));
            }
            if self.member(&resolved(from, target)).is_none() {
                let what =
                    format!("a relationship names the part '{target}', which the file does not contain");
                diagnostics.note(&what, || relationship.at.clone());
            }
        }
        let mut tickets = all.iter().filter(|relationship| relationship.kind == PRINT_TICKET);
        if let (Some(_), Some(second)) = (tickets.next(), tickets.next()) {
            diagnostics.note("a model has more than one print ticket", || second.at.clone());
        }
        Ok(())
    }

    /// Checks that the content types say that a part is a model.
    fn check_type(&self, reading: &mut Reading, member: &str, at: &Span) -> Result<(), FormatError> {
        let types = self.member(TYPES).unwrap_or(TYPES).to_owned();
        let mut xml = self.xml(reading, &types)?;
        let Some(root) = xml.child(Level::DOCUMENT)? else { return Ok(()) };
        let (level, mut found) = (root.inside, None);
        let extension = member.rsplit_once('.').map_or("", |(_, extension)| extension);
        while let Some(element) = xml.child(level)? {
            let is_of = |key: &str, name: &str| {
                element.get(key).is_some_and(|value| value.trim_start_matches('/').eq_ignore_ascii_case(name))
            };
            let kind = || Some(element.words("ContentType").into_owned());
            match element.name {
                "Override" if is_of("PartName", member) => {
                    found = kind();
                    break;
                }
                "Default" if is_of("Extension", extension) => found = kind(),
                _ => {}
            }
        }
        match found {
            Some(kind) if kind.eq_ignore_ascii_case(MODEL_TYPE) => Ok(()),
            Some(kind) => {
                let message =
                    format!("the content type of '{member}' is '{kind}', but a 3D model has '{MODEL_TYPE}'");
                Err(FormatError::malformed(message, at.clone()))
            }
            None => {
                let message = format!("'{TYPES}' does not say what '{member}' is: export the file again");
                Err(FormatError::malformed(message, at.clone()))
            }
        }
    }

    /// The relationships that a member lists; none if it does not exist.
    fn relationships(&self, reading: &mut Reading, member: &str) -> Result<Vec<Relationship>, FormatError> {
        let mut all = Vec::new();
        let Some(member) = self.member(member).map(str::to_owned) else { return Ok(all) };
        let mut xml = self.xml(reading, &member)?;
        let Some(root) = xml.child(Level::DOCUMENT)? else { return Ok(all) };
        let level = root.inside;
        while let Some(element) = xml.child(level)? {
            if element.name != "Relationship" {
                continue;
            }
            let (kind, target) = (element.words("Type").into_owned(), element.words("Target").into_owned());
            reading
                .budget
                .take_bytes(2 * (kind.len() + target.len() + size_of::<Relationship>()) as u64, &self.name)?;
            all.push(Relationship { kind, target, at: element.at() });
        }
        Ok(all)
    }
}

/// The name of the member with the relationships of a part.
fn relationships_of(part: &str) -> String {
    let (folder, name) = part.rsplit_once('/').unwrap_or(("", part));
    let between = if folder.is_empty() { "" } else { "/" };
    format!("{folder}{between}_rels/{name}.rels")
}

/// The name of a part that another part refers to.
pub(super) fn resolved(from: &str, target: &str) -> String {
    let folder =
        if target.starts_with('/') { "" } else { from.rsplit_once('/').map_or("", |(folder, _)| folder) };
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(target.split('/')) {
        match part {
            "" | "." => {}
            ".." => _ = parts.pop(),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// A name with `%20` and the like replaced; `None` if that is no text.
fn percent_decoded(name: &str) -> Option<String> {
    let mut bytes = Vec::new();
    let mut rest = name.as_bytes();
    while let [first, tail @ ..] = rest {
        let code = tail.get(..2).filter(|_| *first == b'%').and_then(|code| std::str::from_utf8(code).ok());
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    String::from_utf8(bytes).ok()
}
