//! Reads JSON and query strings strictly: for a type that denies unknown fields, refuses an unknown member and names
//! the nearest known one. Other errors name their member too.

use super::nearest::{nearest, suggestion};
use serde::de::value::{SeqDeserializer, StringDeserializer};
use serde::de::{
    DeserializeOwned, DeserializeSeed, Deserializer, Error, Expected, IntoDeserializer, MapAccess,
    Unexpected, Visitor,
};
use serde::{Deserialize, forward_to_deserialize_any};
use std::fmt;

/// Error: a body or a query string does not have the form of its type.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unreadable {
    /// Path of the member at fault, for example `values.title_en`; empty when the fault has none.
    pub member: String,
    /// What was found and what was expected.
    pub problem: String,
}

/// Reads the text of a JSON document as a `T`.
///
/// # Errors
/// Fails on a text that is not JSON, and on an unknown, repeated, missing or malformed member.
pub fn from_slice<T: DeserializeOwned>(text: &[u8]) -> Result<T, Unreadable> {
    let Json::Members(members) = serde_json::from_slice(text).map_err(Unreadable::custom)? else {
        return Err(Unreadable::of("", "found no JSON object, expected one"));
    };
    T::deserialize(Json::Members(members.clone())).map_err(|error| match error.member.as_str() {
        "" => error.in_one_of::<T>(members),
        _ => error,
    })
}

/// Makes a `T` of the names and values of a query string, percent-decoded by the caller.
///
/// # Errors
/// Fails on an unknown, repeated, missing or malformed member.
pub fn from_pairs<T: DeserializeOwned>(
    pairs: impl Iterator<Item = (String, String)>,
) -> Result<T, Unreadable> {
    T::deserialize(Pairs(pairs.map(|(name, text)| (name, Text(text)))))
}

impl Unreadable {
    /// Makes the error about a member that is not among `known`.
    pub fn unknown(member: &str, known: &[&str]) -> Self {
        Self::of(
            member,
            format!("found an unknown member, {}", expected(member, known)),
        )
    }

    fn of(member: &str, problem: impl Into<String>) -> Self {
        Self {
            member: short(member),
            problem: problem.into(),
        }
    }

    /// Adds the name of the member at fault, which serde does not report for an enum with a tag: the fault lies in the
    /// first member that, replaced by null, gives no error or another one.
    fn in_one_of<T: DeserializeOwned>(self, members: Vec<(String, Json)>) -> Self {
        let is_at_fault = |at: &usize| {
            let mut without = members.clone();
            without[*at].1 = Json::Null;
            match T::deserialize(Json::Members(without)) {
                Ok(_) => true,
                Err(other) => other.member.is_empty() && other.problem != self.problem,
            }
        };
        let found = (0..members.len()).find(is_at_fault);
        let member = found.map(|at| members[at].0.clone());
        self.inside(member.as_deref().unwrap_or_default())
    }

    fn inside(mut self, member: &str) -> Self {
        let inner = if self.member.is_empty() { "" } else { "." };
        self.member = format!("{}{inner}{}", short(member), self.member);
        self
    }
}

/// Returns the first 80 characters, so that a refusal stays short.
fn short(text: &str) -> String {
    text.chars().take(80).collect()
}

fn expected(word: &str, known: &[&str]) -> String {
    match (nearest(word, known), known) {
        (Some(near), _) => format!("expected {}", suggestion(near)),
        (None, []) => "expected none".to_owned(),
        (None, known) => format!("expected one of {}", known.join(", ")),
    }
}

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.member.as_str() {
            "" => f.write_str(&self.problem),
            member => write!(f, "{member}: {}", self.problem),
        }
    }
}

impl std::error::Error for Unreadable {}

impl Error for Unreadable {
    fn custom<T: fmt::Display>(problem: T) -> Self {
        Self::of("", problem.to_string())
    }

    fn invalid_type(found: Unexpected<'_>, wanted: &dyn Expected) -> Self {
        Self::of("", format!("found {found}, expected {wanted}"))
    }

    fn invalid_value(found: Unexpected<'_>, wanted: &dyn Expected) -> Self {
        Self::invalid_type(found, wanted)
    }

    fn unknown_variant(found: &str, known: &'static [&'static str]) -> Self {
        let expected = expected(found, known);
        Self::of("", format!("found {:?}, {expected}", short(found)))
    }

    fn unknown_field(found: &str, known: &'static [&'static str]) -> Self {
        Self::unknown(found, known)
    }

    fn missing_field(name: &'static str) -> Self {
        Self::of(name, "found nothing, expected a value")
    }

    fn duplicate_field(name: &'static str) -> Self {
        Self::of(name, "found twice, expected once")
    }
}

/// A JSON value from which serde reads a type; keeps repeated members, so that the type refuses them.
#[derive(Clone, Deserialize)]
#[serde(untagged)]
enum Json {
    Members(#[serde(deserialize_with = "members")] Vec<(String, Self)>),
    Items(Vec<Self>),
    Text(String),
    Flag(bool),
    Whole(u64),
    Negative(i64),
    Real(f64),
    Null,
}

fn members<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<(String, Json)>, D::Error> {
    struct All;
    impl<'de> Visitor<'de> for All {
        type Value = Vec<(String, Json)>;

        fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
            out.write_str("a JSON object")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut from: A) -> Result<Self::Value, A::Error> {
            std::iter::from_fn(|| from.next_entry().transpose()).collect()
        }
    }
    from.deserialize_map(All)
}

impl<'de> IntoDeserializer<'de, Unreadable> for Json {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

impl<'de> Deserializer<'de> for Json {
    type Error = Unreadable;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unreadable> {
        match self {
            Self::Members(members) => Pairs(members.into_iter()).deserialize_any(visitor),
            Self::Items(items) => visitor.visit_seq(SeqDeserializer::new(items.into_iter())),
            Self::Text(text) => visitor.visit_string(text),
            Self::Flag(flag) => visitor.visit_bool(flag),
            Self::Whole(number) => visitor.visit_u64(number),
            Self::Negative(number) => visitor.visit_i64(number),
            Self::Real(number) => visitor.visit_f64(number),
            Self::Null => visitor.visit_unit(),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unreadable> {
        match self {
            Self::Null => visitor.visit_none(),
            _ => visitor.visit_some(self),
        }
    }

    /// Reads the tag of an enum, which is a text: serde would take a number for the ordinal of a variant.
    fn deserialize_identifier<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unreadable> {
        match self {
            Self::Text(word) => visitor.visit_string(word),
            _ => Err(Unreadable::of("", "found no text, expected one")),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _name: &'static str,
        visitor: V,
    ) -> Result<V::Value, Unreadable> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unreadable> {
        match self {
            Self::Text(word) => visitor.visit_enum(word.into_deserializer()),
            _ => self.deserialize_any(visitor),
        }
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct seq tuple tuple_struct map struct ignored_any
    }
}

/// Text of a query member, from which serde reads a type: it parses numbers and flags.
struct Text(String);

macro_rules! parsed {
    ($($method:ident $visit:ident $kind:ty, $wanted:literal;)+) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unreadable> {
            match self.0.parse::<$kind>() {
                Ok(value) => visitor.$visit(value),
                Err(_) => Err(Error::invalid_value(Unexpected::Str(&short(&self.0)), &$wanted)),
            }
        }
    )+};
}

impl<'de> Deserializer<'de> for Text {
    type Error = Unreadable;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unreadable> {
        visitor.visit_string(self.0)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unreadable> {
        visitor.visit_some(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _name: &'static str,
        _words: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Unreadable> {
        visitor.visit_enum(self.0.into_deserializer())
    }

    parsed! {
        deserialize_bool visit_bool bool, "true or false";
        deserialize_i8 visit_i8 i8, "a whole number from -128 to 127";
        deserialize_i16 visit_i16 i16, "a whole number from -32768 to 32767";
        deserialize_i32 visit_i32 i32, "a whole number";
        deserialize_i64 visit_i64 i64, "a whole number";
        deserialize_i128 visit_i128 i128, "a whole number";
        deserialize_u8 visit_u8 u8, "a whole number from 0 to 255";
        deserialize_u16 visit_u16 u16, "a whole number from 0 to 65535";
        deserialize_u32 visit_u32 u32, "a whole number from 0";
        deserialize_u64 visit_u64 u64, "a whole number from 0";
        deserialize_u128 visit_u128 u128, "a whole number from 0";
        deserialize_f32 visit_f32 f32, "a number";
        deserialize_f64 visit_f64 f64, "a number";
    }

    forward_to_deserialize_any! {
        char str string bytes byte_buf unit unit_struct newtype_struct seq tuple tuple_struct map struct
        identifier ignored_any
    }
}

/// Members in order, from which serde reads a type; adds the name of a member to the errors of its value.
struct Pairs<I>(I);

impl<'de, D, I> Deserializer<'de> for Pairs<I>
where
    D: Deserializer<'de, Error = Unreadable>,
    I: Iterator<Item = (String, D)>,
{
    type Error = Unreadable;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Unreadable> {
        visitor.visit_map(Entries {
            rest: self.0,
            value: None,
        })
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit
        unit_struct newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

struct Entries<I, D> {
    rest: I,
    value: Option<(String, D)>,
}

impl<'de, D, I> MapAccess<'de> for Entries<I, D>
where
    D: Deserializer<'de, Error = Unreadable>,
    I: Iterator<Item = (String, D)>,
{
    type Error = Unreadable;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, Unreadable> {
        self.value = self.rest.next();
        let Some((name, _)) = &self.value else {
            return Ok(None);
        };
        let name: StringDeserializer<Unreadable> = name.clone().into_deserializer();
        seed.deserialize(name).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(
        &mut self,
        seed: V,
    ) -> Result<V::Value, Unreadable> {
        let (name, value) = self
            .value
            .take()
            .ok_or_else(|| Error::custom("a value without a name"))?;
        seed.deserialize(value).map_err(|error| error.inside(&name))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use serde_json::{Value, json};

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Start {
        lot: String,
        count: Option<u32>,
        rules: Option<Rules>,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum Rules {
        Nelson,
        WesternElectric,
    }

    #[derive(Debug, PartialEq, Deserialize)]
    #[serde(tag = "order", rename_all = "snake_case", deny_unknown_fields)]
    enum Order {
        Stop {},
        Start {
            lot: Option<String>,
            count: Option<u32>,
        },
    }

    fn from_json<T: DeserializeOwned>(json: Value) -> Result<T, Unreadable> {
        from_slice(json.to_string().as_bytes())
    }

    fn start() -> Start {
        Start {
            lot: "A".into(),
            count: Some(7),
            rules: Some(Rules::WesternElectric),
        }
    }

    fn pairs(text: &str) -> Result<Start, Unreadable> {
        let pairs = text.split('&').filter_map(|it| it.split_once('='));
        from_pairs(pairs.map(|(name, text)| (name.to_owned(), text.to_owned())))
    }

    #[test]
    fn json_and_query_string_give_the_same() {
        let json = json!({"lot": "A", "count": 7, "rules": "western-electric"});
        assert_eq!(from_json(json), Ok(start()));
        assert_eq!(pairs("lot=A&count=7&rules=western-electric"), Ok(start()));
    }

    #[test]
    fn a_refusal_names_member_and_nearest_known_one() {
        let said = |json| from_json::<Start>(json).unwrap_err().to_string();
        for (found, expected) in [
            (
                said(json!({"lto": "A"})),
                r#"lto: found an unknown member, expected "lot"?"#,
            ),
            (
                said(json!({"lot": "A", "machine": 1})),
                "machine: found an unknown member, expected one of lot, count, rules",
            ),
            (
                said(json!({"count": 1})),
                "lot: found nothing, expected a value",
            ),
            (
                said(json!({"lot": 7})),
                "lot: found integer `7`, expected a string",
            ),
            (
                said(json!({"lot": "A", "count": -1})),
                "count: found integer `-1`, expected u32",
            ),
            (
                said(json!({"lot": "A", "rules": "nelsen"})),
                r#"rules: found "nelsen", expected "nelson"?"#,
            ),
            (said(json!([])), "found no JSON object, expected one"),
            (
                pairs("lot=A&count=x").unwrap_err().to_string(),
                r#"count: found string "x", expected a whole number from 0"#,
            ),
            (
                pairs("lot=A&lot=B").unwrap_err().to_string(),
                "lot: found twice, expected once",
            ),
        ] {
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn a_tagged_order_takes_its_own_members_only() {
        assert_eq!(from_json(json!({"order": "stop"})), Ok(Order::Stop {}));
        let said = |json| from_json::<Order>(json).unwrap_err().to_string();
        assert_eq!(
            said(json!({"order": "stop", "lot": "A"})),
            "lot: found an unknown member, expected none"
        );
        assert_eq!(
            said(json!({"order": "start", "lto": "A"})),
            r#"lto: found an unknown member, expected "lot"?"#
        );
        assert_eq!(
            said(json!({"order": "stpo"})),
            r#"order: found "stpo", expected "stop"?"#
        );
        assert_eq!(
            said(json!({"order": 1})),
            "order: found no text, expected one"
        );
        assert_eq!(
            said(json!({"order": "start", "count": 1.5})),
            "count: found floating point `1.5`, expected u32"
        );
        assert_eq!(
            said(json!({"lot": "A"})),
            "order: found nothing, expected a value"
        );
        let twice = br#"{"order": "start", "lot": "A", "lot": "B"}"#;
        let said = from_slice::<Order>(twice).unwrap_err().to_string();
        assert_eq!(said, "lot: found twice, expected once");
    }
}
