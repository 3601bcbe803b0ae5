//! Messages: a code with arguments, which programs can compare and the catalogue turns into text.

use crate::catalogue::Text as Pattern;
use crate::{Lang, catalogue};
use fluent_bundle::FluentArgs;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Arguments by name. The value of an argument in [`NAMES`] is a code; the text shows the name of this code.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Args(BTreeMap<Cow<'static, str>, String>);

/// Arguments whose values are codes: `bin` = `coil` shows the text `bin-coil`; `needed_role` shows a text of family
/// `role`.
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

/// Name of the argument that selects an attribute of a text in place of the text itself.
const CASE: &str = "case";

/// A code with arguments, the same in every language. It serialises as `{"code", "args", "en", "zh"}`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    family: &'static str,
    code: Cow<'static, str>,
    args: Args,
}

impl Args {
    /// Returns the value of the argument with this name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// Returns the names of all arguments in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(AsRef::as_ref)
    }

    /// Returns true when there are no arguments.
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

    /// Returns the text that replaces `code`, the value of argument `name`; it may contain the other arguments, as
    /// `motion-axis_bin` contains `bin`.
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

    /// Selects the attribute `case` of the text; a text without this attribute stays as it is.
    #[must_use]
    pub fn case(self, case: &'static str) -> Self {
        self.with(CASE, case)
    }

    /// Returns the code, without its family.
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

    /// Returns the text; panics when the catalogue lacks it or an argument is missing.
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

    /// Returns the text; `None` when an argument is missing, as may happen with a message that another version stored.
    pub fn try_say(&self, lang: Lang) -> Option<String> {
        catalogue::filled(lang, self.pattern(lang)?, &self.args.fluent(lang))
    }

    /// Returns an attribute of the text, if it has one and no argument is missing.
    pub fn try_attribute(&self, lang: Lang, attribute: &str) -> Option<String> {
        let pattern = catalogue::pattern(lang, &self.id(), Some(attribute))?;
        catalogue::filled(lang, pattern, &self.args.fluent(lang))
    }

    /// Returns the text for the selected case, or else the text itself: the case may be meant for a text inside this
    /// one.
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
