//! Options that come from the rows of a table: a row says which values its option takes, and what the help says of it.

pub(crate) mod settings;
mod spelling;

use crate::arguments::assignments::from_flag;
use bilux::math::registry::{Parameter, ParameterKind};
use bilux::scene::{Parameters, Value};
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use std::marker::PhantomData;

/// A table of which a command has the options.
pub trait OptionTable {
    /// Place of the options of the command that follow, under headings that they share with those of the table.
    const NEXT: usize = 100;

    /// Its options, in the order of their headings.
    fn options() -> Vec<TableOption>;
}

/// The options of a table that are given.
#[derive(Clone)]
pub struct TableOptions<T>(pub Parameters, PhantomData<T>);

/// An option that gives a parameter.
pub struct TableOption {
    /// The parameter that it gives.
    pub parameter: &'static Parameter,
    /// Its name without the dashes.
    pub name: String,
    /// Its name of one letter.
    pub short: Option<char>,
    /// The name of its value.
    pub value: String,
    /// The value if none is written, which then has to follow an equals sign.
    pub missing: Option<&'static str>,
    /// The heading under which the help has it.
    pub heading: &'static str,
    /// Its place there.
    pub place: usize,
    /// What the help says of it.
    pub help: String,
    /// How its value is read.
    pub read: Read,
}

/// Reads the value of an option: what it sets, which is its parameter or one that goes with it, and to what.
pub type Read = fn(&'static Parameter, &str) -> Result<(&'static str, Value), String>;

impl<T> TableOptions<T> {
    /// Whether an option sets this.
    pub fn has(&self, key: &str) -> bool {
        self.0.find(key).is_some()
    }

    /// The text that an option gives.
    pub fn text(&self, key: &str) -> Option<&str> {
        match self.0.find(key)?.0 {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The number that an option gives.
    pub fn number(&self, key: &str) -> Option<f32> {
        match self.0.find(key)?.0 {
            Value::Integer(number) => Some(*number as f32),
            Value::Number(number) => Some(*number as f32),
            _ => None,
        }
    }
}

impl TableOption {
    fn arg(&self) -> Arg {
        let (parameter, read) = (self.parameter, self.read);
        let arg = Arg::new(parameter.name)
            .long(self.name.clone())
            .short(self.short)
            .value_name(self.value.clone())
            .value_parser(move |text: &str| read(parameter, text))
            .allow_hyphen_values(self.takes_hyphens())
            .help_heading(self.heading)
            .display_order(self.place)
            .help(self.help.clone());
        match self.missing {
            Some(value) => arg.num_args(0..=1).default_missing_value(value).require_equals(true),
            None => arg,
        }
    }

    /// Whether what begins with a hyphen can be a value: a name does not, and so is the next option.
    fn takes_hyphens(&self) -> bool {
        match self.parameter.kind {
            ParameterKind::Choice(words) => words.iter().any(|word| word.starts_with('-')),
            ParameterKind::Text => !["NAME", "FILE"].iter().any(|name| self.value.contains(name)),
            _ => true,
        }
    }
}

impl<T: OptionTable> Args for TableOptions<T> {
    fn augment_args(command: Command) -> Command {
        command.args(T::options().iter().map(TableOption::arg)).next_display_order(T::NEXT)
    }

    fn augment_args_for_update(command: Command) -> Command {
        TableOptions::<T>::augment_args(command)
    }
}

impl<T: OptionTable> FromArgMatches for TableOptions<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<TableOptions<T>, clap::Error> {
        let mut given = Parameters::default();
        for option in T::options() {
            if let Some((key, value)) = matches.get_one::<(&'static str, Value)>(option.parameter.name) {
                given.set_at(key, value.clone(), from_flag(&format!("--{}", option.name)));
            }
        }
        Ok(TableOptions(given, PhantomData))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = TableOptions::from_arg_matches(matches)?;
        Ok(())
    }
}

/// A summary as a sentence of the help.
pub fn sentence(summary: &str) -> String {
    let mut letters = summary.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
