//! Steps of a page: its commands, the files that it has readers write, and what the test has to know about them.
//!
//! Hidden comments, each before the block that it is about, or on a line of its own:
//!
//! | comment | meaning |
//! | --- | --- |
//! | `<!-- test: skip because REASON -->` | the next block is not run |
//! | `<!-- test: skip inline because REASON -->` | no command within the text of this page is run |
//! | `<!-- test: fails with N -->` | the next block ends with this status |
//! | `<!-- test: save as NAME -->` | the next block is the content of a file |
//! | `<!-- test: before COMMANDS -->` | commands that readers need not see, on one line or several |

/// One step of a page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Action {
    /// Runs this script, which has to end with this status.
    Run { script: String, status: i32 },
    /// Writes a file.
    Write { name: String, text: String },
    /// Runs nothing, for a reason.
    Skip { script: String, reason: String },
}

/// An action, and the line where it stands, from 1.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) line: usize,
    pub(crate) action: Action,
}

/// Comment on the next block.
#[derive(Default)]
struct Next {
    skip: Option<String>,
    status: i32,
    name: Option<String>,
}

/// The steps of a page, in order.
pub(crate) fn steps(markdown: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    let (mut next, mut inline) = (Next::default(), None);
    let mut lines = markdown.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let line_number = number + 1;
        let mut add = |action: Action| steps.push(Step { line: line_number, action });
        if let Some(language) = line.strip_prefix("```") {
            let block: Vec<&str> = lines.by_ref().map(|(_, line)| line).take_while(|l| *l != "```").collect();
            let text = block.join("\n") + "\n";
            match (std::mem::take(&mut next), language) {
                (Next { name: Some(name), .. }, _) => add(Action::Write { name, text }),
                (Next { skip: Some(reason), .. }, "sh" | "console") => {
                    add(Action::Skip { script: text, reason })
                }
                (Next { status, .. }, "sh" | "console") => add(Action::Run { script: text, status }),
                _ => {}
            }
        } else if let Some(comment) = line.strip_prefix("<!-- test: ") {
            let mut comment = comment.to_owned();
            while !comment.contains("-->") {
                let Some((_, more)) = lines.next() else { break };
                comment += &format!("\n{more}");
            }
            let comment = comment.replace("-->", "");
            match read(comment.trim(), &mut next) {
                Some(Comment::Before(script)) => add(Action::Run { script, status: 0 }),
                Some(Comment::SkipInline(reason)) => inline = Some(reason),
                None => {}
            }
        } else {
            for script in commands_in(line) {
                add(match &inline {
                    Some(reason) => Action::Skip { script, reason: reason.clone() },
                    None => Action::Run { script, status: 0 },
                });
            }
        }
    }
    steps
}

/// A comment that is not about the next block.
enum Comment {
    Before(String),
    SkipInline(String),
}

fn read(comment: &str, next: &mut Next) -> Option<Comment> {
    if let Some(reason) = comment.strip_prefix("skip inline because ") {
        return Some(Comment::SkipInline(reason.to_owned()));
    }
    if let Some(script) = comment.strip_prefix("before") {
        return Some(Comment::Before(script.trim().to_owned() + "\n"));
    }
    if let Some(reason) = comment.strip_prefix("skip because ") {
        next.skip = Some(reason.to_owned());
    } else if let Some(name) = comment.strip_prefix("save as ") {
        next.name = Some(name.to_owned());
    } else if let Some(status) = comment.strip_prefix("fails with ") {
        next.status = status.parse().expect("a status is a number");
    } else {
        panic!("a comment that nobody understands: {comment}");
    }
    None
}

/// The whole commands within the text of a line: in backticks, with what they need, and without placeholders such as
/// `SCENE` or `…`.
fn commands_in(line: &str) -> Vec<String> {
    let spans = line.split('`').skip(1).step_by(2);
    let whole = spans.filter(|span| {
        let words: Vec<&str> = span.split_whitespace().collect();
        let is_placeholder = |word: &&str| {
            let word = word.trim_matches(|c: char| !c.is_alphabetic());
            word.len() > 1 && word.chars().all(|c| c.is_ascii_uppercase())
        };
        let is_bilux = words.first() == Some(&"bilux") && is_whole(&words[1..]);
        is_bilux && !span.contains('…') && !words.iter().any(is_placeholder)
    });
    whole.map(|span| format!("{span}\n")).collect()
}

/// Whether the arguments of `bilux` are more than a mention of a subcommand or of one of its options.
fn is_whole(arguments: &[&str]) -> bool {
    match arguments {
        [option] => option.starts_with('-') || *option == "schema",
        [.., "--help"] => true,
        ["render" | "convert" | "generate" | "denoise" | "sensor" | "merge" | "farm", rest @ ..] => {
            rest.iter().position(|word| *word == "-o").is_some_and(|at| at + 1 < rest.len())
        }
        // Benchmarks take minutes.
        ["bench", ..] => false,
        [_, first, ..] => !first.starts_with('-'),
        [] => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_comments_and_files_are_found() {
        let page = "# A\n<!-- test: before bilux a -o b -->\nSee `bilux info`, `bilux render -o` and `bilux info b -o c`, `bilux b SCENE x`.\n\n\
            <!-- test: save as x.toml -->\n```toml\nx = 1\n```\n<!-- test: fails with 1 -->\n```sh\nbilux c \\\n  d\n```\n\
            <!-- test: skip because it is long -->\n```console\nbilux e\n```\n```text\nbilux f\n```\n";
        let run = |script: &str, status| Action::Run { script: script.to_owned(), status };
        let expected = [
            (2, run("bilux a -o b\n", 0)),
            (3, run("bilux info b -o c\n", 0)),
            (6, Action::Write { name: "x.toml".into(), text: "x = 1\n".into() }),
            (10, run("bilux c \\\n  d\n", 1)),
            (15, Action::Skip { script: "bilux e\n".into(), reason: "it is long".into() }),
        ];
        assert_eq!(steps(page), expected.map(|(line, action)| Step { line, action }));
    }

    #[test]
    fn a_page_may_skip_what_stands_in_its_text() {
        let page = "<!-- test: skip inline because of time -->\n`bilux info rays -v`\n";
        let action = Action::Skip { script: "bilux info rays -v\n".into(), reason: "of time".into() };
        assert_eq!(steps(page), [Step { line: 2, action }]);
    }
}
