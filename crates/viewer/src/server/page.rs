//! The files of the page, which are in the program: nothing is read from a disk or fetched from elsewhere.

use axum::http::header;
use axum::response::{IntoResponse, Response};

/// A file of the page.
pub(super) struct File {
    /// The path of the file; the page itself has none.
    pub(super) path: &'static str,
    kind: &'static str,
    bytes: &'static [u8],
}

macro_rules! file {
    ($path:literal, $name:literal, $kind:literal) => {
        File { path: $path, kind: $kind, bytes: include_bytes!(concat!("../../page/", $name)) }
    };
}

/// All files of the page.
pub(super) static FILES: &[File] = &[
    file!("", "index.html", "text/html; charset=utf-8"),
    file!("style.css", "style.css", "text/css; charset=utf-8"),
    file!("icon.svg", "icon.svg", "image/svg+xml"),
    file!("main.js", "main.js", "text/javascript; charset=utf-8"),
    file!("connection.js", "connection.js", "text/javascript; charset=utf-8"),
    file!("picture.js", "picture.js", "text/javascript; charset=utf-8"),
    file!("address.js", "address.js", "text/javascript; charset=utf-8"),
    file!("busy.js", "busy.js", "text/javascript; charset=utf-8"),
    file!("navigation.js", "navigation.js", "text/javascript; charset=utf-8"),
    file!("controls.js", "controls.js", "text/javascript; charset=utf-8"),
    file!("inputs.js", "inputs.js", "text/javascript; charset=utf-8"),
    file!("edits.js", "edits.js", "text/javascript; charset=utf-8"),
    file!("compare.js", "compare.js", "text/javascript; charset=utf-8"),
    file!("plot.js", "plot.js", "text/javascript; charset=utf-8"),
    file!("accelerators.js", "accelerators.js", "text/javascript; charset=utf-8"),
    file!("model.js", "model.js", "text/javascript; charset=utf-8"),
    file!("drop.js", "drop.js", "text/javascript; charset=utf-8"),
    file!("status.js", "status.js", "text/javascript; charset=utf-8"),
    file!("pick.js", "pick.js", "text/javascript; charset=utf-8"),
    file!("paths.js", "paths.js", "text/javascript; charset=utf-8"),
    file!("element.js", "element.js", "text/javascript; charset=utf-8"),
];

/// Sends a file.
pub(super) fn respond(file: &'static File) -> Response {
    ([(header::CONTENT_TYPE, file.kind)], file.bytes).into_response()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_whole_and_fetches_nothing_from_elsewhere() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("page");
        let names: Vec<_> =
            std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name()).collect();
        for name in &names {
            let name = name.to_str().unwrap();
            assert!(
                name == "index.html" || FILES.iter().any(|file| file.path == name),
                "{name} is not served"
            );
        }
        assert_eq!(names.len(), FILES.len());
        for file in FILES {
            let text = std::str::from_utf8(file.bytes).unwrap();
            let links = text.matches("http://").count() + text.matches("https://").count();
            // The name of SVG is an address that nothing is fetched from.
            assert_eq!(links, text.matches("http://www.w3.org/2000/svg").count(), "{}", file.path);
        }
    }
}
