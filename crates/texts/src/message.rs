//! A code with its arguments: what a text is made of, and what programs compare.

use crate::{Lang, catalogue};
use fluent_bundle::FluentArgs;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Arguments by name. Those that [`NAMES`] lists are codes, said by the text of their own family.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Args(BTreeMap<Cow<'static, str>, String>);

/// Arguments that name a thing of the catalogue: `bin` = `coil` is said as `bin-coil`, `needed_role` by the family `role`.
const NAMES: [&str; 7] = [
    "bin",
    "place",
    "motion",
    "side",
    "wears",
    "found_role",
    "needed_role",
];

/// The argument that chooses one of several texts of a code: the attribute of this name.
const CASE: &str = "case";

/// A text with its arguments, in no language yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Message {
    family: &'static str,
    code: Cow<'static, str>,
    args: Args,
}

/// A message as pages and programs get it: `{"code", "args", "en", "zh"}`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Said {
    /// Code within its family.
    pub code: String,
    /// Arguments by name.
    pub args: Args,
    /// English.
    pub en: String,
    /// Simplified Chinese.
    pub zh: String,
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

    /// The name of a thing; that of a motion may speak of a bin.
    fn named<'a>(&'a self, lang: Lang, name: &str, code: &'a str) -> Cow<'a, str> {
        let family = name.rsplit('_').next().unwrap_or(name);
        let Some(pattern) = catalogue::pattern(lang, &format!("{family}-{code}"), None) else {
            return Cow::Borrowed(code);
        };
        let bin = self.get("bin").map(|bin| ("bin", lang.name("bin", bin)));
        let args: FluentArgs<'_> = bin.into_iter().collect();
        let text = catalogue::filled(lang, pattern, &args);
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

    /// For pages and programs.
    pub fn said(&self) -> Said {
        Said {
            code: self.code.clone().into_owned(),
            args: self.args.clone(),
            en: self.say(Lang::En),
            zh: self.say(Lang::Zh),
        }
    }

    fn pattern(&self, lang: Lang) -> Option<&'static fluent_syntax::ast::Pattern<&'static str>> {
        catalogue::pattern(lang, &self.id(), self.args.get(CASE))
    }
}
