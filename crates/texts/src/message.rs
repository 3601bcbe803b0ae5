//! A code with its arguments: what a text is made of, and what programs compare.

use crate::catalogue::Text as Pattern;
use crate::{Lang, catalogue};
use fluent_bundle::FluentArgs;
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Arguments by name. Those that [`NAMES`] lists are codes, said by the text of their own family.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Args(BTreeMap<Cow<'static, str>, String>);

/// Arguments that name a thing of the catalogue: `bin` = `coil` is said as `bin-coil`, `needed_role` by the family `role`.
const NAMES: [&str; 11] = [
    "alarm",
    "bin",
    "characteristic",
    "fault",
    "interruption",
    "place",
    "motion",
    "side",
    "wears",
    "found_role",
    "needed_role",
];

/// The argument that chooses one of several texts of a code: the attribute of this name.
const CASE: &str = "case";

/// A text with its arguments, in no language yet. Programs get it as `{"code", "args", "en", "zh"}`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    family: &'static str,
    code: Cow<'static, str>,
    args: Args,
}

impl Args {
    /// The argument of this name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    /// Names, in order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.0.keys().map(AsRef::as_ref)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// These and one more.
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

    /// The text of a thing, which may speak of the other arguments: the way of the axis of a bin, an alarm of all its own.
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
    /// The text of a code without arguments yet.
    pub fn new(family: &'static str, code: impl Into<Cow<'static, str>>) -> Self {
        Self::of(family, code, Args::default())
    }

    /// The text of a code with these arguments.
    pub fn of(family: &'static str, code: impl Into<Cow<'static, str>>, args: Args) -> Self {
        Self {
            family,
            code: code.into(),
            args,
        }
    }

    /// With one more argument.
    #[must_use]
    pub fn with(mut self, name: &'static str, value: impl ToString) -> Self {
        self.args = self.args.with(name, value);
        self
    }

    /// The text that the code has for this case.
    #[must_use]
    pub fn case(self, case: &'static str) -> Self {
        self.with(CASE, case)
    }

    /// Code within its family.
    pub fn code(&self) -> &str {
        &self.code
    }

    /// Its arguments.
    pub fn args(&self) -> &Args {
        &self.args
    }

    /// Family and code.
    pub fn id(&self) -> String {
        format!("{}-{}", self.family, self.code)
    }

    /// Its text.
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

    /// Its text; none where an argument is missing: it was stored by another version.
    pub fn try_say(&self, lang: Lang) -> Option<String> {
        catalogue::filled(lang, self.pattern(lang)?, &self.args.fluent(lang))
    }

    /// An attribute of its text.
    pub fn try_attribute(&self, lang: Lang, attribute: &str) -> Option<String> {
        let pattern = catalogue::pattern(lang, &self.id(), Some(attribute))?;
        catalogue::filled(lang, pattern, &self.args.fluent(lang))
    }

    /// A text that speaks of another one carries the case of that one, and has none of its own.
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
