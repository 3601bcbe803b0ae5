//! Program messages: framing of a byte stream, message units, headers and parameters as IEEE 488.2 and SCPI define
//! them.

use super::status::Failure;

/// Greatest length of a message without its blocks, bytes; a longer one overruns the input buffer.
const LONGEST: usize = 8_192;

/// Numbers by which SCPI encodes infinity (also an over-range reading) and, in the next constant, not a number.
const INFINITE: f64 = 9.9e37;
const NOT_A_NUMBER: f64 = 9.91e37;

/// Splits a byte stream into messages at line feeds; a line feed inside a definite block is data.
#[derive(Debug, Default)]
pub struct Framer {
    bytes: Vec<u8>,
    inside: Inside,
}

#[derive(Debug, Default, Clone, Copy, PartialEq)]
enum Inside {
    #[default]
    Plain,
    Quotes(u8),
    Hash,
    /// Number of digits of the block length still to come, and the length so far.
    Length(u8, usize),
    /// Number of bytes of a block still to come.
    Block(usize),
}

impl Framer {
    /// Adds one byte; returns the message that this byte ends, without its terminator.
    ///
    /// # Errors
    /// Fails with -363 when the message is longer than the input buffer.
    pub fn push(&mut self, byte: u8) -> Result<Option<Vec<u8>>, Failure> {
        if byte == b'\n' && !matches!(self.inside, Inside::Block(_)) {
            return Ok(Some(self.end()));
        }
        self.inside = self.inside.after(byte);
        self.bytes.push(byte);
        if self.bytes.len() > LONGEST && !matches!(self.inside, Inside::Block(_)) {
            self.clear();
            return Err(Failure::INPUT_OVERRUN);
        }
        Ok(None)
    }

    /// Ends the message, as END on the GPIB does.
    pub fn end(&mut self) -> Vec<u8> {
        self.inside = Inside::Plain;
        let mut message = std::mem::take(&mut self.bytes);
        while message.last().is_some_and(|last| b"\r\n".contains(last)) {
            message.pop();
        }
        message
    }

    /// Discards the partial message.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

impl Inside {
    fn after(self, byte: u8) -> Self {
        match (self, byte) {
            (Self::Plain, b'"' | b'\'') => Self::Quotes(byte),
            (Self::Plain, b'#') => Self::Hash,
            (Self::Quotes(open), _) if open != byte => self,
            (Self::Hash, b'1'..=b'9') => Self::Length(byte - b'0', 0),
            (Self::Length(left, length), b'0'..=b'9') => {
                let length = length * 10 + usize::from(byte - b'0');
                match left {
                    1 if length == 0 => Self::Plain,
                    1 => Self::Block(length),
                    left => Self::Length(left - 1, length),
                }
            }
            (Self::Block(left), _) if left > 1 => Self::Block(left - 1),
            (_, _) => Self::Plain,
        }
    }
}

/// One message unit: a command or a query, with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// Nodes of the header in upper case; a common command has one node, which begins with `*`.
    pub nodes: Vec<String>,
    /// True for a query.
    pub query: bool,
    /// Parameters as sent, quotes and blocks included.
    pub parameters: Vec<Vec<u8>>,
}

/// Splits a message into units. A unit without a leading colon continues the path of the previous unit.
pub fn units(message: &[u8]) -> Vec<Result<Unit, Failure>> {
    let mut path: Vec<String> = Vec::new();
    let units = split(message, b';');
    let filled = units.iter().filter(|unit| !unit.trim_ascii().is_empty());
    filled
        .map(|unit| unit_of(unit.trim_ascii(), &mut path))
        .collect()
}

fn unit_of(text: &[u8], path: &mut Vec<String>) -> Result<Unit, Failure> {
    let end = text.iter().position(u8::is_ascii_whitespace);
    let (header, rest) = text.split_at(end.unwrap_or(text.len()));
    let header = std::str::from_utf8(header).map_err(|_| Failure::INVALID_CHARACTER)?;
    let (header, query) = match header.strip_suffix('?') {
        Some(header) => (header, true),
        None => (header, false),
    };
    let valid = |c: char| c.is_ascii_alphanumeric() || "*:_".contains(c);
    if let Some(bad) = header.chars().find(|&c| !valid(c)) {
        return Err(match bad.is_ascii_graphic() {
            true => Failure::SYNTAX,
            false => Failure::INVALID_CHARACTER,
        });
    }
    let upper = header.to_ascii_uppercase();
    let upper = upper
        .strip_prefix(':')
        .filter(|it| it.starts_with('*'))
        .unwrap_or(&upper)
        .to_owned();
    let nodes = match (upper.starts_with('*'), upper.strip_prefix(':')) {
        (true, _) => vec![upper],
        (false, Some(absolute)) => absolute.split(':').map(str::to_owned).collect(),
        (false, None) => path
            .iter()
            .cloned()
            .chain(upper.split(':').map(str::to_owned))
            .collect(),
    };
    if nodes.iter().any(String::is_empty) {
        return Err(Failure::SYNTAX);
    }
    if !nodes[0].starts_with('*') {
        path.clone_from(&nodes);
        path.pop();
    }
    let rest = rest.trim_ascii();
    let parameters = match rest.is_empty() {
        true => Vec::new(),
        false => split(rest, b',')
            .into_iter()
            .map(|it| it.trim_ascii().to_vec())
            .collect(),
    };
    Ok(Unit {
        nodes,
        query,
        parameters,
    })
}

/// Splits a text at each separator outside quotes, blocks and channel lists.
fn split(text: &[u8], separator: u8) -> Vec<&[u8]> {
    let (mut parts, mut from, mut depth) = (Vec::new(), 0, 0usize);
    let mut inside = Inside::Plain;
    for (at, &byte) in text.iter().enumerate() {
        let was_plain = inside == Inside::Plain;
        inside = inside.after(byte);
        match byte {
            b'(' if was_plain => depth += 1,
            b')' if was_plain => depth = depth.saturating_sub(1),
            byte if byte == separator && depth == 0 && was_plain => {
                parts.push(&text[from..at]);
                from = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&text[from..]);
    parts
}

impl Unit {
    /// Matches the header against a pattern such as `[:SOURce#]:VOLTage[:LEVel]`: capitals are the short form,
    /// brackets hold optional nodes, `#` allows a numeric suffix. Returns the suffixes, 1 where the header has none.
    pub fn matches(&self, pattern: &str) -> Option<Vec<u32>> {
        let mut suffixes = Vec::new();
        follow(&self.nodes, pattern, &mut suffixes).then_some(suffixes)
    }

    /// Returns a parameter as text without quotes, in capitals.
    ///
    /// # Errors
    /// Fails with -109 when the parameter is missing.
    pub fn word(&self, number: usize) -> Result<String, Failure> {
        let bytes = self
            .parameters
            .get(number)
            .ok_or(Failure::MISSING_PARAMETER)?;
        let text = String::from_utf8_lossy(bytes);
        Ok(text.trim_matches(['"', '\'']).to_ascii_uppercase())
    }

    /// Returns the index of the choice that the first parameter selects; each choice is a pattern of short and long
    /// form.
    ///
    /// # Errors
    /// Fails with -109 without a parameter, with -224 when the parameter is none of the choices.
    pub fn choice(&self, choices: &[&str]) -> Result<usize, Failure> {
        let word = self.word(0)?;
        let word = word.strip_suffix(":DC").unwrap_or(&word);
        let known = choices.iter().position(|choice| forms(word, choice));
        known.ok_or(Failure::ILLEGAL_VALUE)
    }

    /// Returns a number within limits; `MIN`, `MAX` and `DEF` give the lower limit, the upper limit and the default.
    ///
    /// # Errors
    /// Fails with -109 when the parameter is missing, with -104 when it is no number, with -222 outside the limits.
    pub fn number(&self, at: usize, least: f64, most: f64, default: f64) -> Result<f64, Failure> {
        let word = self.word(at)?;
        let number = match word.as_str() {
            word if forms(word, "MINimum") => least,
            word if forms(word, "MAXimum") => most,
            word if forms(word, "DEFault") => default,
            word => with_unit(word).ok_or(Failure::DATA_TYPE)?,
        };
        let slack = 1e-9 * number.abs();
        match number >= least - slack && number <= most + slack {
            true => Ok(number),
            false => Err(Failure::OUT_OF_RANGE),
        }
    }

    /// Returns a boolean: ON, OFF or a number, of which 0 means off.
    ///
    /// # Errors
    /// Fails with -109 when the parameter is missing, with -104 when it is no boolean.
    pub fn boolean(&self) -> Result<bool, Failure> {
        match self.word(0)?.as_str() {
            "ON" => Ok(true),
            "OFF" => Ok(false),
            word => with_unit(word)
                .map(|it| it.round() != 0.0)
                .ok_or(Failure::DATA_TYPE),
        }
    }
}

/// Checks whether a word is the short or the long form of a pattern such as `VOLTage` or `CHANnel1`.
fn forms(word: &str, pattern: &str) -> bool {
    let stem = pattern.trim_end_matches(|c: char| c.is_ascii_digit());
    let short = stem.trim_end_matches(|c: char| c.is_ascii_lowercase());
    let digits = &pattern[stem.len()..];
    let is_short = |word: &str| {
        word.strip_suffix(digits)
            .is_some_and(|it| it.eq_ignore_ascii_case(short))
    };
    word.eq_ignore_ascii_case(pattern) || is_short(word)
}

fn follow(nodes: &[String], pattern: &str, suffixes: &mut Vec<u32>) -> bool {
    if pattern.is_empty() {
        return nodes.is_empty();
    }
    let (node, optional, rest) = match pattern.strip_prefix('[') {
        Some(inner) => {
            let (node, rest) = inner.split_once(']').unwrap_or((inner, ""));
            (node, true, rest)
        }
        None => {
            let from = usize::from(pattern.starts_with(':'));
            let end = pattern[from..]
                .find([':', '['])
                .map_or(pattern.len(), |at| at + from);
            (&pattern[..end], false, &pattern[end..])
        }
    };
    let node = node.trim_start_matches(':');
    let count = suffixes.len();
    if let Some((first, others)) = nodes.split_first()
        && fits(first, node, suffixes)
        && follow(others, rest, suffixes)
    {
        return true;
    }
    suffixes.truncate(count);
    if optional && node.ends_with('#') {
        suffixes.push(1);
    }
    let skipped = optional && follow(nodes, rest, suffixes);
    if !skipped {
        suffixes.truncate(count);
    }
    skipped
}

fn fits(word: &str, node: &str, suffixes: &mut Vec<u32>) -> bool {
    let Some(node) = node.strip_suffix('#') else {
        return forms(word, node);
    };
    let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let suffix = match &word[name.len()..] {
        "" => Some(1),
        digits => digits.parse().ok(),
    };
    match suffix {
        Some(suffix) if forms(name, node) => {
            suffixes.push(suffix);
            true
        }
        Some(_) | None => false,
    }
}

/// Parses a number (NR1, NR2, NR3, `#H`, `#Q`, `#B`, INF or NAN) with an optional unit and unit prefix.
fn with_unit(word: &str) -> Option<f64> {
    for (prefix, radix) in [("#H", 16), ("#Q", 8), ("#B", 2)] {
        if let Some(digits) = word.strip_prefix(prefix) {
            return i64::from_str_radix(digits, radix).ok().map(|it| it as f64);
        }
    }
    match word {
        "INF" | "INFINITY" => return Some(INFINITE),
        "NINF" => return Some(-INFINITE),
        "NAN" => return Some(NOT_A_NUMBER),
        _ => {}
    }
    let numeric = |c: char| c.is_ascii_digit() || "+-.".contains(c);
    let bytes = word.as_bytes();
    let mut end = bytes
        .iter()
        .take_while(|&&c| numeric(char::from(c)))
        .count();
    if let Some(exponent) = word[end..].strip_prefix('E') {
        let digits = exponent.trim_start_matches(['+', '-']);
        let count = digits.bytes().take_while(u8::is_ascii_digit).count();
        if count > 0 {
            end += 1 + exponent.len() - digits.len() + count;
        }
    }
    let number: f64 = word[..end].parse().ok()?;
    Some(number * scale(word[end..].trim())?)
}

/// Returns the factor of a unit with its prefix; `M` means milli except in MHZ and MOHM.
fn scale(unit: &str) -> Option<f64> {
    if unit.is_empty() {
        return Some(1.0);
    }
    let units = ["OHM", "PCT", "DEG", "HZ", "V", "A", "S", "W"];
    let prefix = units.iter().find_map(|it| unit.strip_suffix(it))?;
    let big = unit.ends_with("HZ") || unit.ends_with("OHM");
    match prefix {
        "" => Some(1.0),
        "MA" => Some(1e6),
        "M" if big => Some(1e6),
        "M" => Some(1e-3),
        "K" => Some(1e3),
        "U" => Some(1e-6),
        "N" => Some(1e-9),
        "P" => Some(1e-12),
        _ => None,
    }
}

/// Formats a number as NR3 with eight significant digits; infinity and NaN become the SCPI values for them.
pub fn nr3(value: f64) -> String {
    let value = match value {
        value if value.is_nan() => NOT_A_NUMBER,
        value => value.clamp(-INFINITE, INFINITE),
    };
    let text = format!("{value:+.7E}");
    match text.split_once('E') {
        Some((mantissa, exponent)) => {
            let exponent: i32 = exponent.parse().unwrap_or_default();
            format!("{mantissa}E{exponent:+03}")
        }
        None => text,
    }
}

/// Wraps bytes into a definite block with a length of `digits` digits.
pub fn block(bytes: &[u8], digits: usize) -> Vec<u8> {
    let mut block = format!("#{digits}{:0digits$}", bytes.len()).into_bytes();
    block.extend_from_slice(bytes);
    block
}
