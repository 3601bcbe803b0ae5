//! Asks a history file and a database the same random questions, which must have the same answers to the last digit.
//!
//! Filters combine all options that the command line has; their values come from the parts themselves, so that most
//! answers are not empty. A refusal is an answer too.

mod draw;
mod question;

use draw::Draw;
use history::Archive;
use machine::dut::Recipe;
use question::Question;

/// Result of a comparison.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Asked {
    /// Number of questions.
    pub questions: u32,
    /// Number of answers that were refusals.
    pub refused: u32,
    /// Bytes of all answers.
    pub bytes: usize,
    /// Questions with different answers, in words, with the first place of the difference.
    pub different: Vec<String>,
}

/// Asks `count` questions, drawn from `seed`; a question that judges parts again uses one of `recipes`. The database
/// must have all rows of the file and answer for this rig alone.
///
/// # Errors
/// Fails when the file cannot be read, or has no part.
pub fn compare(
    (file, database): (&Archive, &Archive),
    (count, seed): (u32, u64),
    recipes: &[Recipe],
) -> history::Result<Asked> {
    let mut draw = Draw::of(file, seed)?;
    let mut asked = Asked::default();
    for _ in 0..count {
        let question = Question::draw(&mut draw, recipes.len());
        let [here, there] = [file, database].map(|it| question.answer(it, recipes));
        asked.questions += 1;
        asked.bytes += here.as_ref().map_or(0, String::len);
        asked.refused += u32::from(here.is_err());
        let [here, there] =
            [here, there].map(|it| it.unwrap_or_else(|refused| refused.to_string()));
        if here != there {
            asked.different.push(told(&question, &here, &there));
        }
    }
    Ok(asked)
}

/// Returns the question with the first place where the answers differ.
fn told(question: &Question, here: &str, there: &str) -> String {
    let same = here.bytes().zip(there.bytes()).take_while(|(a, b)| a == b);
    let from = same.count().saturating_sub(40);
    let piece = |text: &str| text.bytes().skip(from).take(120).collect::<Vec<u8>>();
    let [here, there] = [here, there].map(|it| String::from_utf8_lossy(&piece(it)).into_owned());
    format!("{question:?}: file ...{here}..., database ...{there}...")
}
