//! A function fits on a screen: about 60 lines, and never more than 80. Split a longer one into named parts.

use super::repository::Repository;
use super::violation::Violation;

const LONGEST: usize = 80;

/// Path, function, reason.
const EXCEPTIONS: &[(&str, &str, &str)] = &[];

pub(super) fn check(repository: &Repository) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (file, rust) in repository.rust().filter(|(file, _)| !file.is_test()) {
        let end = file.lines_before_tests();
        for function in functions(&rust.code) {
            let excepted =
                EXCEPTIONS.iter().any(|(path, name, _)| *path == file.path && *name == function.name);
            if function.lines > LONGEST && function.line <= end && !excepted {
                let message = format!("`{}` has {} lines, {LONGEST} at most", function.name, function.lines);
                violations.push(Violation::new(&file.path, function.line, message));
            }
        }
    }
    violations
}

struct Function {
    name: String,
    /// The line of its `fn`, from 1.
    line: usize,
    /// The number of lines from its `fn` to its closing brace.
    lines: usize,
}

/// Every function with a body, including nested ones.
fn functions(code: &str) -> Vec<Function> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut functions = Vec::new();
    for (at, _) in code.match_indices("fn ").filter(|(at, _)| !code[..*at].ends_with(is_word)) {
        let name: String = code[at + 3..].chars().take_while(|c| is_word(*c)).collect();
        let Some(length) = body_end(&code[at..]).filter(|_| !name.is_empty()) else { continue };
        let line = 1 + code[..at].matches('\n').count();
        functions.push(Function { name, line, lines: 1 + code[at..at + length].matches('\n').count() });
    }
    functions
}

/// The offset of the closing brace of the first body; `None` if a semicolon comes first.
fn body_end(code: &str) -> Option<usize> {
    let (mut nesting, mut braces) = (0, 0);
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' => nesting += 1,
            ')' | ']' => nesting -= 1,
            ';' if nesting == 0 && braces == 0 => return None,
            '{' => braces += 1,
            '}' => {
                braces -= 1;
                if braces == 0 {
                    return Some(at);
                }
            }
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check_text(text: &str) -> Vec<Violation> {
        check(&Repository::planted(&[("a.rs", text)]))
    }

    #[test]
    fn a_long_function_is_found_by_name_and_line() {
        let body = "    // }\n".repeat(80);
        let found = check_text(&format!("\nfn short() {{}}\nfn long(x: [u8; 3]) {{\n{body}}}\n"));
        assert_eq!(found, [Violation::new("a.rs", 3, "`long` has 82 lines, 80 at most")]);
    }

    #[test]
    fn short_ones_declarations_and_tests_pass() {
        let body = "    \"{\";\n".repeat(78);
        assert!(check_text(&format!("fn f() {{\n{body}}}\n")).is_empty());
        assert!(check_text(&format!("trait T {{\nfn f(&self);\n{}}}\n", "\n".repeat(90))).is_empty());
        let long = "\n".repeat(90);
        assert!(check_text(&format!("#[cfg(test)]\nmod tests {{\nfn f() {{{long}}}\n}}")).is_empty());
        assert!(check_text(&format!("type F = fn (u8);\nstruct Often {{{long}}}")).is_empty());
    }
}
