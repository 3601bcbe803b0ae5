//! Texts of the page, of paper and of answers, in English and Chinese.
//!
//! `locale/en.ftl` and `locale/zh.ftl` hold the texts in Fluent, made of literals and `{ $argument }` only. The id of a
//! text is its family and its code, for example `alarm-door_open`; attributes (`.cause`, `.action`) hold further texts
//! of the same code. A missing id, attribute or argument is a bug and fails an assertion.
//!
//! ```
//! use texts::{Lang, Message};
//! assert_eq!(Lang::Zh.text("bin-coil"), "线圈不良箱");
//! let full = Message::new("alarm", "bin_full").with("bin", "coil");
//! assert!(full.say(Lang::En).starts_with("The beam of bin coil stays dark."));
//! ```

mod catalogue;
mod json_form;
mod message;

pub use catalogue::{Plain, arguments, attributes, ids, plain};
pub use message::{Args, Message};

use serde::Deserialize;
use utoipa::ToSchema;

/// Language of a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize, ToSchema)]
#[serde(rename_all = "lowercase")]
pub enum Lang {
    /// English.
    En,
    /// Simplified Chinese.
    Zh,
}

impl Lang {
    /// All languages.
    pub const ALL: [Self; 2] = [Self::En, Self::Zh];

    /// Returns the value of the HTML attribute `lang`.
    pub const fn tag(self) -> &'static str {
        match self {
            Self::En => "en",
            Self::Zh => "zh-CN",
        }
    }

    /// Returns the separator of a list: in English a comma and a blank, in Chinese the enumeration comma alone.
    pub const fn comma(self) -> &'static str {
        match self {
            Self::En => ", ",
            Self::Zh => "\u{3001}",
        }
    }

    /// Returns the separator of clauses: a semicolon, and in English a blank.
    pub const fn semicolon(self) -> &'static str {
        match self {
            Self::En => "; ",
            Self::Zh => "\u{ff1b}",
        }
    }

    /// Returns the mark before an explanation: a colon, and in English a blank.
    pub const fn colon(self) -> &'static str {
        match self {
            Self::En => ": ",
            Self::Zh => "\u{ff1a}",
        }
    }

    /// Returns the text `id`, which must have no arguments.
    pub fn text(self, id: &str) -> &'static str {
        catalogue::plain_text(self, id, None)
    }

    /// Returns an attribute of the text `id`, which must have no arguments.
    pub fn attribute(self, id: &str, attribute: &str) -> &'static str {
        catalogue::plain_text(self, id, Some(attribute))
    }

    /// Returns the name of `code` in its family. Returns `code` itself when the catalogue lacks the code, because a
    /// plant may name bins and parameter keys of its own.
    pub fn name<'a>(self, family: &str, code: &'a str) -> &'a str {
        let id = format!("{family}-{code}");
        if catalogue::has(&id) {
            self.text(&id)
        } else {
            code
        }
    }
}
