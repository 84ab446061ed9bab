//! The name of the test that runs.

/// The path of the test that this thread runs: libtest gives the thread its name. With `--exact`, as nextest asks for it, the
/// name is an argument too. `None` in other threads.
pub(super) fn test_name() -> Option<String> {
    name_of(std::thread::current().name(), std::env::args().skip(1))
}

fn name_of(thread: Option<&str>, arguments: impl Iterator<Item = String>) -> Option<String> {
    match thread {
        Some(name) if name != "main" => Some(name.to_owned()),
        Some(_) => {
            let arguments: Vec<String> = arguments.collect();
            let mut names = arguments.iter().filter(|word| !word.starts_with('-'));
            let is_exact = arguments.iter().any(|word| word == "--exact");
            names.next().filter(|_| is_exact && names.next().is_none()).cloned()
        }
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_have_the_names_of_their_threads() {
        assert!(test_name().unwrap().ends_with("tests_have_the_names_of_their_threads"));
        assert_eq!(std::thread::scope(|scope| scope.spawn(test_name).join().unwrap()), None);
    }

    #[test]
    fn a_test_in_the_main_thread_is_named_by_the_arguments() {
        let of = |line: &str| name_of(Some("main"), line.split_whitespace().map(str::to_owned));
        assert_eq!(of("a::b --exact --nocapture").as_deref(), Some("a::b"));
        assert_eq!(of("--exact a::b"), Some("a::b".to_owned()));
        assert_eq!(of("a::b"), None);
        assert_eq!(of("a::b c --exact"), None);
        assert_eq!(of("--exact"), None);
    }
}
