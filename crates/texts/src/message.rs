//! Messages: codes with arguments. Programs compare the codes; the catalogue turns a message into text.

use crate::catalogue::Text as Pattern;
use crate::{Lang, catalogue, json_form};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::collections::BTreeMap;
use utoipa::ToSchema;

/// Arguments by name. For some names the value is a code; the text then shows the name of this code.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(transparent)]
pub struct Args(BTreeMap<Cow<'static, str>, String>);

/// Arguments whose values are codes, each with the family of the codes: `bin` = `coil` shows the text `bin-coil`.
const NAMES: [(&str, &str); 33] = [
    ("actuator", "actuator"),
    ("alarm", "alarm"),
    ("bin", "bin"),
    ("blocker", "body"),
    ("cause", "cause"),
    ("characteristic", "characteristic"),
    ("detail", "detail"),
    ("expects", "signal"),
    ("failure", "instrument"),
    ("fault", "fault"),
    ("found_role", "role"),
    ("input", "signal"),
    ("interruption", "interruption"),
    ("line", "line"),
    ("member", "member"),
    ("missed", "detail"),
    ("module", "module"),
    ("motion", "motion"),
    ("mover", "body"),
    ("needed", "mode"),
    ("needed_role", "role"),
    ("next", "next"),
    ("pins", "pin"),
    ("place", "place"),
    ("promise", "promise"),
    ("reason", "reason"),
    ("refusal", "refusal"),
    ("rejection", "rejection"),
    ("request", "request"),
    ("side", "side"),
    ("step", "step"),
    ("transaction", "transaction"),
    ("wears", "wears"),
];

/// Families whose codes may come as a list: `pusher_extended=1, pusher_retracted=0`.
const LISTS: [&str; 4] = ["member", "module", "pin", "signal"];

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

    /// Adds argument `name` with the code of `inner` as its value, and all arguments of `inner`. Where a text uses
    /// `name`, the catalogue shows the text of `inner`.
    ///
    /// # Panics
    /// Panics when the catalogue looks `name` up in another family of codes than that of `inner`, or when both messages
    /// have an argument of the same name with different values.
    #[must_use]
    pub fn with_inner(mut self, name: &'static str, inner: &Message) -> Self {
        assert_eq!(family(name), Some(inner.family), "family of {name}");
        for (arg, value) in &inner.args.0 {
            let own = self.0.insert(arg.clone(), value.clone());
            assert!(own.is_none_or(|own| own == *value), "two values of {arg}");
        }
        self.with(name, inner.code())
    }

    /// Returns the text of a pattern with these arguments; `None` when one is missing.
    fn fill(&self, lang: Lang, pattern: &'static Pattern) -> Option<String> {
        let said = |name: &str, code| match family(name) {
            Some(family) if LISTS.contains(&family) => Cow::Owned(listed(lang, family, code)),
            Some(family) => self.named(lang, name, family, code),
            None => Cow::Borrowed(code),
        };
        let own = |name| self.get(name).map(|code| (name, said(name, code)));
        let used = catalogue::used(pattern).filter_map(own);
        catalogue::filled(lang, pattern, &used.collect())
    }

    /// Returns the text that replaces `code`, the value of argument `name`. This text may use the other arguments, as
    /// `motion-axis_bin` uses `bin`.
    fn named<'a>(&'a self, lang: Lang, name: &str, family: &str, code: &'a str) -> Cow<'a, str> {
        let id = format!("{family}-{code}");
        let case = catalogue::pattern(lang, &id, self.get(CASE));
        let Some(pattern) = case.or_else(|| catalogue::pattern(lang, &id, None)) else {
            return Cow::Borrowed(code);
        };
        let mut others = self.clone();
        others.0.remove(name);
        Cow::Owned(others.fill(lang, pattern).unwrap_or_default())
    }
}

/// Returns the family of the codes that argument `name` takes; `None` for an argument whose values are no codes.
fn family(name: &str) -> Option<&'static str> {
    NAMES.iter().find(|it| it.0 == name).map(|it| it.1)
}

/// Replaces each code of a list by its name; keeps a state after the name, as in `door_closed=1`.
fn listed(lang: Lang, family: &str, codes: &str) -> String {
    let name = |code: &str| {
        let id = code.replace(' ', "_");
        let name = lang.name(family, &id);
        if name == id { code } else { name }.to_owned()
    };
    let piece = |piece: &str| match piece.split_once('=') {
        Some((code, state)) => format!("{} = {state}", name(code)),
        None => name(piece),
    };
    let pieces: Vec<String> = codes.split(", ").map(piece).collect();
    pieces.join(lang.comma())
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

    /// Makes a message of family `detail` with `said`, English words of a library, the system or the plant. The English
    /// text shows `said`; the Chinese text uses the other arguments.
    pub fn detail(code: &'static str, said: impl ToString) -> Self {
        Self::new("detail", code).with("said", said)
    }

    /// Adds the code of `inner` as argument `name`, and all arguments of `inner`; texts show the text of `inner` for
    /// `name`.
    #[must_use]
    pub fn with_inner(mut self, name: &'static str, inner: &Self) -> Self {
        self.args = self.args.with_inner(name, inner);
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

    /// Returns the text; `None` when the text is unknown or an argument is missing, as may happen with a message that
    /// another version stored.
    pub fn try_say(&self, lang: Lang) -> Option<String> {
        self.args.fill(lang, self.pattern(lang)?)
    }

    /// Returns an attribute of the text; `None` when the text lacks the attribute, or when an argument is missing.
    pub fn try_attribute(&self, lang: Lang, attribute: &str) -> Option<String> {
        let pattern = catalogue::pattern(lang, &self.id(), Some(attribute))?;
        self.args.fill(lang, pattern)
    }

    /// Returns the attribute for the selected case, or else the text itself, because the case may concern the text of
    /// an inner message.
    fn pattern(&self, lang: Lang) -> Option<&'static Pattern> {
        let case = catalogue::pattern(lang, &self.id(), self.args.get(CASE));
        case.or_else(|| catalogue::pattern(lang, &self.id(), None))
    }
}

/// JSON form of a [`Message`].
#[derive(Serialize, ToSchema)]
#[schema(as = Message)]
struct Shown<'a> {
    /// Code, unique within its family.
    code: &'a str,
    /// Arguments by name.
    args: &'a Args,
    /// English text.
    en: String,
    /// Chinese text.
    zh: String,
}

impl<'a> From<&'a Message> for Shown<'a> {
    fn from(message: &'a Message) -> Self {
        Self {
            code: &message.code,
            args: &message.args,
            en: message.say(Lang::En),
            zh: message.say(Lang::Zh),
        }
    }
}

json_form!(Message, Shown);
