//! Messages: codes with arguments, which programs compare and a catalogue turns into text.

use crate::catalogue::Text as Pattern;
use crate::{Lang, catalogue};
use fluent_bundle::FluentArgs;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Arguments by name. Values of the names in [`NAMES`] are codes, which a text of their own family replaces.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Args(BTreeMap<Cow<'static, str>, String>);

/// Arguments whose values are codes: `bin` = `coil` becomes the text `bin-coil`, `needed_role` uses the family `role`.
const NAMES: [&str; 12] = [
    "alarm",
    "bin",
    "characteristic",
    "fault",
    "interruption",
    "place",
    "motion",
    "promise",
    "side",
    "wears",
    "found_role",
    "needed_role",
];

/// Argument whose value names the attribute that replaces the text of a code.
const CASE: &str = "case";

/// A code with arguments, independent of language. It serialises as `{"code", "args", "en", "zh"}`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    family: &'static str,
    code: Cow<'static, str>,
    args: Args,
}

impl Args {
    /// Returns the argument of this name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// Returns the names in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(AsRef::as_ref)
    }

    /// Returns true without arguments.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds an argument.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.0.insert(name.into(), value.to_string());
        self
    }

    fn fluent(&self, lang: Lang) -> FluentArgs<'_> {
        let said = |name: &str, code| match NAMES.contains(&name) {
            true => self.named(lang, name, code),
            false => Cow::Borrowed(code),
        };
        let pairs = self.0.iter();
        pairs
            .map(|(name, value)| (name.as_ref(), said(name, value)))
            .collect()
    }

    /// Returns the text of a code, which may contain the other arguments: `motion-axis_bin` contains `bin`.
    fn named<'a>(&'a self, lang: Lang, name: &str, code: &'a str) -> Cow<'a, str> {
        let family = name.rsplit('_').next().unwrap_or(name);
        let id = format!("{family}-{code}");
        let case = catalogue::pattern(lang, &id, self.get(CASE));
        let Some(pattern) = case.or_else(|| catalogue::pattern(lang, &id, None)) else {
            return Cow::Borrowed(code);
        };
        let mut others = self.clone();
        others.0.remove(name);
        let text = catalogue::filled(lang, pattern, &others.fluent(lang));
        Cow::Owned(text.unwrap_or_default())
    }
}

impl Message {
    /// Makes a message without arguments.
    pub fn new(family: &'static str, code: impl Into<Cow<'static, str>>) -> Self {
        Self::of(family, code, Args::default())
    }

    /// Makes a message with these arguments.
    pub fn of(family: &'static str, code: impl Into<Cow<'static, str>>, args: Args) -> Self {
        Self {
            family,
            code: code.into(),
            args,
        }
    }

    /// Adds an argument.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.args = self.args.with(name, value);
        self
    }

    /// Chooses the text of the code for this case.
    #[must_use]
    pub fn case(self, case: &'static str) -> Self {
        self.with(CASE, case)
    }

    /// Returns the code, without family.
    pub fn code(&self) -> &str {
        &self.code
    }

    /// Returns the arguments.
    pub fn args(&self) -> &Args {
        &self.args
    }

    /// Returns the id in the catalogue: family and code.
    pub fn id(&self) -> String {
        format!("{}-{}", self.family, self.code)
    }

    /// Returns the text; an assertion fails without one.
    pub fn say(&self, lang: Lang) -> String {
        let said = self.try_say(lang);
        assert!(
            said.is_some(),
            "no text {} in {lang:?}: {:?}",
            self.id(),
            self.args
        );
        said.unwrap_or_default()
    }

    /// Returns the text; `None` when an argument is missing, as in messages that another version has stored.
    pub fn try_say(&self, lang: Lang) -> Option<String> {
        catalogue::filled(lang, self.pattern(lang)?, &self.args.fluent(lang))
    }

    /// Returns an attribute of the text, if it has one and no argument is missing.
    pub fn try_attribute(&self, lang: Lang, attribute: &str) -> Option<String> {
        let pattern = catalogue::pattern(lang, &self.id(), Some(attribute))?;
        catalogue::filled(lang, pattern, &self.args.fluent(lang))
    }

    /// Falls back to the text without case: a text that contains another one carries the case of the inner one.
    fn pattern(&self, lang: Lang) -> Option<&'static Pattern> {
        let case = catalogue::pattern(lang, &self.id(), self.args.get(CASE));
        case.or_else(|| catalogue::pattern(lang, &self.id(), None))
    }
}

impl Serialize for Message {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("Message", 4)?;
        object.serialize_field("code", &self.code)?;
        object.serialize_field("args", &self.args)?;
        object.serialize_field("en", &self.say(Lang::En))?;
        object.serialize_field("zh", &self.say(Lang::Zh))?;
        object.end()
    }
}
