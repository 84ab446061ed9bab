//! The modules of a crate, and which module each name that they mention comes from.

use super::repository::{Repository, TextFile};
use super::rust_text::RustText;
use std::collections::{BTreeMap, BTreeSet};

/// Enums that are tables: each variant holds the type of one file, which registers itself there.
const CLOSED_SETS: &[&str] = &["Lobe", "Phase"];

/// Number of re-exports that a name may pass through.
const MAX_REEXPORTS: usize = 16;

/// One file of a crate's `src`, without its tests.
pub(super) struct Module {
    /// `["integrators", "path"]`; empty for the root of the crate.
    pub(super) place: Vec<String>,
    /// The path of its file.
    pub(super) file: String,
    imports: Vec<Import>,
    paths: Vec<Mention>,
}

/// A name that a module mentions, and where it does first.
pub(super) struct Mention {
    segments: Vec<String>,
    /// From 1.
    pub(super) line: usize,
}

struct Import {
    /// The name that the module calls it by; `*` for all.
    name: String,
    path: Mention,
    /// Whether the module itself needs it, rather than passing it on or naming it in a table.
    is_used: bool,
}

/// The modules of a crate by their places.
pub(super) struct Modules(BTreeMap<Vec<String>, Module>);

impl Modules {
    /// Reads the files of `FOLDER/src`.
    pub(super) fn read(repository: &Repository, folder: &str) -> Modules {
        let prefix = format!("{folder}/src/");
        let in_crate = |file: &TextFile| Some(place(file.path.strip_prefix(&prefix)?));
        let files: Vec<_> =
            repository.rust().filter_map(|(file, rust)| Some((in_crate(file)?, file, rust))).collect();
        let places: Vec<_> = files.iter().map(|(place, ..)| place.clone()).collect();
        let mut tests = Vec::new();
        let mut modules = BTreeMap::new();
        for (place, file, rust) in files {
            let children: BTreeSet<&str> =
                places.iter().filter_map(|child| child_of(&place, child)).collect();
            let (tokens, of_tests) = outside_tests(tokens(rust));
            tests.extend(of_tests.into_iter().map(|name| [&place[..], &[name]].concat()));
            modules.insert(place.clone(), Module::new(place.clone(), &file.path, &tokens, &children));
        }
        modules.retain(|place, _| !tests.iter().any(|test| place.starts_with(test)));
        Modules(modules)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Module> {
        self.0.values()
    }

    /// Every module of this crate that a module uses something of, with the line that says so.
    pub(super) fn used_by<'a>(&'a self, user: &'a Module) -> impl Iterator<Item = (&'a Module, usize)> {
        let imports = user.imports.iter().filter(|import| import.is_used).map(|import| &import.path);
        imports
            .chain(&user.paths)
            .filter_map(|mention| Some((self.resolve(user, &mention.segments, MAX_REEXPORTS)?, mention.line)))
    }

    /// The module in which a path ends, as seen from another; `None` for a name of another crate.
    fn resolve<'a>(&'a self, from: &'a Module, path: &[String], depth: usize) -> Option<&'a Module> {
        let (first, rest) = path.split_first()?;
        let mut rest = rest;
        let mut at = match first.as_str() {
            "crate" => self.0.get(&[][..])?,
            "self" => from,
            "super" => self.parent(from)?,
            _ => {
                rest = path;
                self.named(from, first, depth)?
            }
        };
        if rest.len() == path.len() {
            rest = &rest[1..];
        }
        for segment in rest {
            at = match segment.as_str() {
                "super" => self.parent(at)?,
                "*" => return Some(at),
                name => match self.named(at, name, depth) {
                    Some(next) => next,
                    None if at.imports.iter().any(|import| import.name == name) => return None,
                    None => return Some(at),
                },
            };
        }
        Some(at)
    }

    fn parent(&self, module: &Module) -> Option<&Module> {
        self.0.get(&module.place[..module.place.len().checked_sub(1)?])
    }

    /// The module that a name leads to: a child, or where an import of that name ends.
    fn named<'a>(&'a self, at: &'a Module, name: &str, depth: usize) -> Option<&'a Module> {
        if let Some(child) = self.0.get(&[&at.place[..], &[name.to_owned()]].concat()) {
            return Some(child);
        }
        let import = at.imports.iter().find(|import| import.name == name)?;
        self.resolve(at, &import.path.segments, depth.checked_sub(1)?)
    }
}

impl Module {
    fn new(place: Vec<String>, file: &str, tokens: &[Token], children: &BTreeSet<&str>) -> Module {
        let (imports, rest) = imports(tokens);
        let rest = outside_tables(&rest);
        // A name in a path, a field, a declaration or the scope of a visibility is none; after `..` it is one.
        let before = |at: usize, back: usize| at.checked_sub(back).map_or("", |at| rest[at].text);
        let is_start = |at: usize| match before(at, 1) {
            "::" | "mod" => false,
            "." => before(at, 2) == ".",
            "in" => before(at, 2) != "(",
            _ => true,
        };
        let starts: Vec<usize> = (0..rest.len()).filter(|&at| is_start(at)).collect();
        let mut paths = Vec::new();
        for &at in &starts {
            let leads = |text| matches!(text, "crate" | "self" | "super") || children.contains(text);
            if rest.get(at + 1).is_some_and(|next| next.text == "::") && leads(rest[at].text) {
                paths.push(Mention { segments: path(&rest[at..]), line: rest[at].line });
            }
        }
        let everywhere = |name: &str| tokens.iter().filter(|token| token.text == name).count();
        let is_root = place.is_empty();
        let is_folder = file.ends_with("/mod.rs") || file.ends_with("/lib.rs");
        let imports = imports.into_iter().map(|(is_public, mut import)| {
            let first = import.path.segments.first().map_or("", String::as_str);
            let passes_on =
                is_public && is_folder && (first == "self" || children.contains(first) || is_root);
            let here = starts.iter().any(|&at| rest[at].text == import.name);
            // A trait may be needed for its methods only, and a glob for anything.
            let is_silent = everywhere(&import.name) <= 1;
            import.is_used = here || is_silent && !passes_on;
            import
        });
        Module { place, file: file.to_owned(), imports: imports.collect(), paths }
    }
}

/// `integrators/mod.rs` is the module `["integrators"]`.
fn place(file: &str) -> Vec<String> {
    let mut parts: Vec<_> = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
    parts.pop_if(|last| last == "mod" || last == "lib" || last == "main");
    parts
}

/// The name of a module's file or folder, if it lies in that of another.
fn child_of<'a>(place: &[String], child: &'a [String]) -> Option<&'a str> {
    match child.strip_prefix(place)? {
        [name] => Some(name),
        _ => None,
    }
}

#[derive(Clone, Copy)]
struct Token<'a> {
    text: &'a str,
    line: usize,
}

/// Words, `::`, and every other character that is no space.
fn tokens(rust: &RustText) -> Vec<Token<'_>> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut tokens = Vec::new();
    for (number, mut line) in rust.code.lines().enumerate() {
        while let Some(first) = line.chars().next() {
            let word = line.find(|c| !is_word(c)).unwrap_or(line.len());
            let length = if line.starts_with("::") { 2 } else { word.max(first.len_utf8()) };
            let (text, rest) = line.split_at(length);
            if !first.is_whitespace() {
                tokens.push(Token { text, line: number + 1 });
            }
            line = rest;
        }
    }
    tokens
}

/// Leaves out what follows `#[cfg(test)]`, and says which files that concerns.
fn outside_tests(tokens: Vec<Token<'_>>) -> (Vec<Token<'_>>, Vec<String>) {
    let (mut kept, mut files, mut at) = (Vec::new(), Vec::new(), 0);
    while at < tokens.len() {
        if !starts_with(&tokens[at..], &["#", "[", "cfg", "(", "test", ")", "]"]) {
            kept.push(tokens[at]);
            at += 1;
            continue;
        }
        let end = at + 7 + item(&tokens[at + 7..]);
        let declared =
            tokens[at..end].windows(3).find(|three| three[0].text == "mod" && three[2].text == ";");
        files.extend(declared.map(|three| three[1].text.to_owned()));
        at = end;
    }
    (kept, files)
}

/// Leaves out the rows of tables: `static NAMES: &[NameEntry] = …;` and the variants of [`CLOSED_SETS`].
fn outside_tables<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        let rest = &tokens[at..];
        let words: Vec<_> = rest.iter().take(7).map(|token| token.text).collect();
        let is_table = match words[..] {
            ["static", _, ":", "&", "[", ..] => {
                let kind = rest[5..].iter().take_while(|token| token.text != "]").last();
                kind.is_some_and(|kind| kind.text.ends_with("Entry"))
            }
            ["enum", name, ..] => CLOSED_SETS.contains(&name),
            _ => false,
        };
        if is_table {
            at += item(rest);
        } else {
            kept.push(tokens[at]);
            at += 1;
        }
    }
    kept
}

/// The number of tokens to the end of an item: its semicolon or its closing brace, whichever comes first.
fn item(tokens: &[Token]) -> usize {
    let (mut nesting, mut braces) = (0, 0);
    for (at, token) in tokens.iter().enumerate() {
        match token.text {
            "(" | "[" => nesting += 1,
            ")" | "]" => nesting -= 1,
            ";" if nesting == 0 && braces == 0 => return at + 1,
            "{" => braces += 1,
            "}" => {
                braces -= 1;
                if braces == 0 && nesting == 0 {
                    return at + 1;
                }
            }
            _ => {}
        }
    }
    tokens.len()
}

/// The imports, each with whether it is passed on, and the tokens that are in none.
fn imports<'a>(tokens: &[Token<'a>]) -> (Vec<(bool, Import)>, Vec<Token<'a>>) {
    let (mut imports, mut rest, mut at) = (Vec::new(), Vec::new(), 0);
    while at < tokens.len() {
        if tokens[at].text != "use" {
            rest.push(tokens[at]);
            at += 1;
            continue;
        }
        let length = tokens[at..].iter().take_while(|token| token.text != ";").count();
        let is_public = at > 0 && matches!(tokens[at - 1].text, "pub" | ")");
        let mut found = Vec::new();
        tree(&tokens[at + 1..at + length], &[], &mut found);
        imports.extend(found.into_iter().map(|import| (is_public, import)));
        at += length;
    }
    (imports, rest)
}

/// Everything that `a::{b, c as d, e::*}` imports; returns how many tokens that took.
fn tree(tokens: &[Token], before: &[String], found: &mut Vec<Import>) -> usize {
    let mut segments = before.to_vec();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token.text {
            "{" => {
                at += 1;
                while tokens.get(at).is_some_and(|token| token.text != "}") {
                    at += tree(&tokens[at..], &segments, found);
                    at += usize::from(tokens.get(at).is_some_and(|token| token.text == ","));
                }
                return at + 1;
            }
            "," | "}" | "as" => break,
            "::" => {}
            "self" if !segments.is_empty() => {}
            text => segments.push(text.to_owned()),
        }
        at += 1;
    }
    let alias = tokens.get(at).filter(|token| token.text == "as").and(tokens.get(at + 1));
    at += if alias.is_some() { 2 } else { 0 };
    let name = alias.map(|token| token.text.to_owned()).or_else(|| segments.last().cloned());
    let line = tokens.first().map_or(0, |token| token.line);
    found.extend(name.map(|name| Import { name, path: Mention { segments, line }, is_used: true }));
    at
}

/// The path that tokens begin with.
fn path(tokens: &[Token]) -> Vec<String> {
    let is_word = |text: &str| text.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let words = tokens.chunks(2).take_while(|pair| is_word(pair[0].text));
    let mut segments = Vec::new();
    for pair in words {
        segments.push(pair[0].text.to_owned());
        if pair.get(1).is_none_or(|next| next.text != "::") {
            break;
        }
    }
    segments
}

fn starts_with(tokens: &[Token], words: &[&str]) -> bool {
    tokens.len() >= words.len() && tokens.iter().zip(words).all(|(token, word)| token.text == *word)
}
