//! Reads the text into a table.

use super::lexer::{Lexer, Token};
use super::table::{Instance, Record, Table, place};
use super::value::{Piece, Value};
use bilux_import::FormatError;
use bilux_import::bytes::text::whole_file;
use bilux_import::input::diagnostics::Diagnostics;
use bilux_import::input::reading::Reading;
use std::collections::HashMap;
use std::sync::Arc;

/// Lists within lists; the geometry of STEP has two levels.
const MAX_DEPTH: usize = 64;

/// Values of open lists, of which so many count against the budget at once.
const LONG: usize = 1 << 16;

/// The memory of one instance apart from its values, with what a growing table takes.
const PER_INSTANCE: u64 = 2 * (size_of::<(u64, Instance)>() + size_of::<u64>() + size_of::<Record>()) as u64;

/// Reads a whole file. Instances that cannot be read are left out, with a fault.
pub(crate) fn parse<'a>(
    reading: &mut Reading,
    bytes: &'a [u8],
    file: &Arc<str>,
) -> Result<Table<'a>, FormatError> {
    if u32::try_from(bytes.len()).is_err() {
        let message = "STEP files above 4 GB are not read: export the assembly in parts";
        return Err(FormatError::malformed(message, whole_file(file)));
    }
    let table = Table {
        bytes,
        file: file.clone(),
        values: Vec::new(),
        records: Vec::new(),
        header: Vec::new(),
        instances: HashMap::new(),
        order: Vec::new(),
        is_whole: false,
        faults: Diagnostics::default(),
    };
    let mut parser = Parser {
        reading,
        lexer: Lexer { bytes, at: 0 },
        table,
        stack: Vec::new(),
        starts: Vec::new(),
        charged: 0,
    };
    parser.file()?;
    if parser.table.order.is_empty() {
        let message =
            "it has no DATA section with instances such as #1=…;: it is not a STEP file, or it was cut off";
        return Err(FormatError::malformed(message, whole_file(file)));
    }
    Ok(parser.table)
}

struct Parser<'a, 'r, 'o> {
    reading: &'r mut Reading<'o>,
    lexer: Lexer<'a>,
    table: Table<'a>,
    /// Values of lists that are open.
    stack: Vec<Value>,
    /// Place on the stack at which the values of each open list begin, and whether it is a typed value.
    starts: Vec<(usize, bool)>,
    /// The values that have been charged to the budget.
    charged: usize,
}

/// Why an instance cannot be read.
enum Fault {
    /// The instance is left out.
    Odd(&'static str),
    TooLarge(FormatError),
}

impl Parser<'_, '_, '_> {
    fn file(&mut self) -> Result<(), FormatError> {
        let mut is_data = false;
        loop {
            let start = self.lexer.at;
            match self.lexer.next() {
                Token::End => break,
                Token::Keyword(name) => match name.of(self.lexer.bytes) {
                    b"DATA" => {
                        is_data = true;
                        self.skip();
                    }
                    b"ENDSEC" | b"HEADER" | b"ISO-10303-21" | b"ANCHOR" | b"REFERENCE" | b"SIGNATURE" => {
                        is_data = false;
                        self.skip();
                    }
                    b"END-ISO-10303-21" => {
                        self.table.is_whole = true;
                        return Ok(());
                    }
                    _ if !is_data => match self.record(name) {
                        Ok(record) => self.table.header.push(record),
                        Err(fault) => self.fault(fault, start)?,
                    },
                    _ => self.fault(
                        Fault::Odd("a name stands where an instance such as #1=… should begin"),
                        start,
                    )?,
                },
                Token::Reference(id) if is_data => {
                    // The offset of the number sign.
                    let blanks = self.lexer.bytes[start..].iter().position(|&byte| byte == b'#').unwrap_or(0);
                    let before = (self.table.values.len(), self.table.records.len());
                    match self.instance(id, start + blanks) {
                        Ok(()) => self.charge()?,
                        Err(fault) => {
                            self.table.values.truncate(before.0);
                            self.table.records.truncate(before.1);
                            self.charged = self.charged.min(before.0);
                            self.fault(fault, start + blanks)?;
                        }
                    }
                }
                Token::Semicolon => {}
                _ if !is_data => self.skip(),
                _ => self.fault(
                    Fault::Odd("something stands where an instance such as #1=… should begin"),
                    start,
                )?,
            }
        }
        let end = self.lexer.bytes.len();
        self.table.faults.note("the file has no end (END-ISO-10303-21;): it may be cut off", || {
            place(self.table.bytes, &self.table.file, end)
        });
        Ok(())
    }

    fn charge(&mut self) -> Result<(), FormatError> {
        let new = self.table.values.len() - self.charged;
        self.charged = self.table.values.len();
        self.reading.budget.take_bytes(PER_INSTANCE, &self.table.file)?;
        self.reading.budget.take::<Value>(new, &self.table.file)
    }

    /// Notes a fault, and goes on after the next semicolon.
    fn fault(&mut self, fault: Fault, offset: usize) -> Result<(), FormatError> {
        let what = match fault {
            Fault::Odd(what) => what,
            Fault::TooLarge(error) => return Err(error),
        };
        let Table { bytes, file, faults, .. } = &mut self.table;
        faults.note(what, || place(bytes, file, offset));
        self.stack.clear();
        self.starts.clear();
        self.skip();
        Ok(())
    }

    fn skip(&mut self) {
        while !matches!(self.lexer.next(), Token::Semicolon | Token::End) {}
    }

    fn instance(&mut self, id: u64, offset: usize) -> Result<(), Fault> {
        if self.lexer.next() != Token::Equals {
            return Err(Fault::Odd("an instance has no equals sign, and is left out"));
        }
        let first = self.table.records.len();
        match self.lexer.next() {
            Token::Keyword(name) => {
                let record = self.record(name)?;
                self.table.records.push(record);
            }
            Token::Open => loop {
                match self.lexer.next() {
                    Token::Keyword(name) => {
                        let record = self.record(name)?;
                        self.table.records.push(record);
                    }
                    Token::Close => break,
                    _ => {
                        return Err(Fault::Odd("an instance of several parts is malformed, and is left out"));
                    }
                }
            },
            _ => return Err(Fault::Odd("an instance has no name of an entity, and is left out")),
        }
        if self.lexer.next() != Token::Semicolon {
            return Err(Fault::Odd("an instance does not end in a semicolon, and is left out"));
        }
        let count = (self.table.records.len() - first) as u32;
        let instance = Instance { first: first as u32, count, offset: offset as u32 };
        if self.table.instances.insert(id, instance).is_none() {
            self.table.order.push(id);
            return Ok(());
        }
        let Table { bytes, file, faults, .. } = &mut self.table;
        faults
            .note("a number of an instance occurs twice: the last one counts", || place(bytes, file, offset));
        Ok(())
    }

    /// The parameters after a name.
    fn record(&mut self, name: Piece) -> Result<Record, Fault> {
        if self.lexer.next() != Token::Open {
            return Err(Fault::Odd("an entity has no parameters in parentheses, and is left out"));
        }
        self.starts.push((self.stack.len(), false));
        // Without recursion: the depth of the file costs no stack.
        loop {
            let value = match self.lexer.next() {
                Token::Comma => continue,
                Token::Missing => Value::Missing,
                Token::Number(number) => Value::Number(number),
                Token::Reference(id) => Value::Reference(id),
                Token::Text(text) => Value::Text(text),
                Token::Name(name) => Value::Name(name),
                Token::Open => {
                    self.open(false)?;
                    continue;
                }
                Token::Keyword(_) => {
                    if self.lexer.next() != Token::Open {
                        return Err(Fault::Odd(
                            "a typed value has no parentheses, and its instance is left out",
                        ));
                    }
                    self.open(true)?;
                    continue;
                }
                Token::Close => {
                    let (start, is_typed) = self.starts.pop().unwrap_or_default();
                    let first = self.table.values.len() as u32;
                    let count = (self.stack.len() - start) as u32;
                    self.table.values.extend(self.stack.drain(start..));
                    if self.starts.is_empty() {
                        return Ok(Record { name, first, count });
                    }
                    if is_typed && count == 1 { Value::Typed(first) } else { Value::List { first, count } }
                }
                Token::Semicolon | Token::Equals | Token::Wrong | Token::End => {
                    return Err(Fault::Odd(
                        "the parameters of an entity are malformed, and its instance is left out",
                    ));
                }
            };
            self.stack.push(value);
            if self.stack.len().is_multiple_of(LONG) {
                let taken = self.reading.budget.take::<Value>(LONG, &self.table.file);
                taken.map_err(Fault::TooLarge)?;
            }
        }
    }

    fn open(&mut self, is_typed: bool) -> Result<(), Fault> {
        if self.starts.len() >= MAX_DEPTH {
            return Err(Fault::Odd(
                "parentheses are nested more than 64 levels deep, and their instance is left out",
            ));
        }
        self.starts.push((self.stack.len(), is_typed));
        Ok(())
    }
}
