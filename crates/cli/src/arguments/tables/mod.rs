//! Options that come from the rows of a table: a row says which values its option takes, and what the help says of it.

pub(crate) mod settings;
mod spelling;

use crate::arguments::assignments::from_flag;
use crate::arguments::help::HEADINGS;
use bilux::scene::{Parameters, Value};
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use std::marker::PhantomData;

/// A table of which a command has the options.
pub trait OptionTable {
    /// Place of the options of the command that follow, under headings that they share with those of the table.
    const NEXT: usize = 100;

    /// Its options, each of which reads [`Assigned`].
    fn options() -> Vec<Arg>;
}

/// What an option sets, which is its parameter or one that goes with it, and to what.
pub type Assigned = (&'static str, Value);

/// The parameters that options of a table give.
#[derive(Clone)]
pub struct TableOptions<T>(pub Parameters, PhantomData<T>);

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

impl<T: OptionTable> Args for TableOptions<T> {
    fn augment_args(command: Command) -> Command {
        let mut options = T::options();
        // Headings appear in the help as they first do among the options.
        let place = |option: &Arg| HEADINGS.iter().position(|name| Some(*name) == option.get_help_heading());
        options.sort_by_key(place);
        command.args(options).next_display_order(T::NEXT)
    }

    fn augment_args_for_update(command: Command) -> Command {
        TableOptions::<T>::augment_args(command)
    }
}

impl<T: OptionTable> FromArgMatches for TableOptions<T> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<TableOptions<T>, clap::Error> {
        let mut given = Parameters::default();
        for option in T::options() {
            if let Some((key, value)) = matches.get_one::<Assigned>(option.get_id().as_str()) {
                let flag = format!("--{}", option.get_long().unwrap_or_default());
                given.set_at(key, value.clone(), from_flag(&flag));
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
