//! Exports the selected parts as CSV or spreadsheet; the memory needed does not grow with their number. A spreadsheet
//! names the filter, so that its reader knows which parts the figures cover; the spreadsheet of one lot also lists the
//! answers to prompts.

use super::Result;
use super::figures::agreed;
use crate::columns::{self, Cell};
use crate::report::sheet::{Sheet, SheetFacts};
use crate::report::{Paper, external_sentence, figure, parameter, short_hash};
use crate::{Archive, Filter, csv};
use machine::dut::External;
use rust_xlsxwriter::Workbook;
use std::collections::BTreeSet;
use std::io::Write;

/// Writes the header and one line per part; last the results of the part from outside of the rig, where a selected lot
/// has any. `history import` can read the file back; no text acts as a formula.
pub fn csv_lines(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    out: &mut impl Write,
) -> Result<()> {
    let external = external_keys(archive, filter)?;
    let header = columns::header(parameters).into_iter();
    csv::write(out, header.chain(columns::external_header(&external)))?;
    archive.each(filter, |part| {
        let cells = columns::row(&part, parameters).chain(columns::external(&part, &external));
        let texts = cells.map(|cell| match cell {
            Cell::Text(text) => csv::escape_formula(&text).into_owned(),
            figure => figure.to_string(),
        });
        csv::write(out, texts)
    })??;
    Ok(())
}

/// Returns the quantities of which the selected lots have results from outside of the rig.
fn external_keys(archive: &Archive, filter: &Filter) -> Result<Vec<External>> {
    let mut lots: Vec<String> = archive
        .lots(filter)?
        .into_iter()
        .filter(|it| it.external.is_some())
        .map(|it| it.lot)
        .collect();
    lots.dedup();
    let mut keys = BTreeSet::new();
    for lot in lots {
        let results = archive.external_results(&lot)?;
        keys.extend(results.iter().filter_map(|it| External::from_key(&it.key)));
    }
    Ok(keys.into_iter().collect())
}

/// Returns a spreadsheet with a summary and native charts; calls `each` for every part.
pub fn spreadsheet(
    archive: &Archive,
    filter: &Filter,
    parameters: &[String],
    paper: &Paper,
    mut each: impl FnMut(),
) -> Result<Workbook> {
    let mut sheet = Sheet::new(paper, parameters, &external_keys(archive, filter)?)?;
    archive.each(filter, |part| {
        each();
        sheet.part(&part)
    })??;
    let limits = |key: &String| Ok(agreed(archive.limits_of(key, filter)?));
    let about = SheetFacts {
        facts: facts(archive, filter, paper)?,
        limits: parameters.iter().map(limits).collect::<Result<_>>()?,
    };
    Ok(sheet.finish(&about)?)
}

/// Returns facts for the summary, named in the language of the paper: the recipes of the runs, the members of the
/// filter, and the answers to prompts of the filter's lot.
fn facts(archive: &Archive, filter: &Filter, paper: &Paper) -> Result<Vec<(String, String)>> {
    let language = paper.language;
    let mut recipes: Vec<String> = archive
        .lots(filter)?
        .iter()
        .map(|run| format!("{} ({})", run.recipe, short_hash(&run.recipe_hash)))
        .collect();
    recipes.sort();
    recipes.dedup();
    let name = |code| language.name("bin", code).to_owned();
    let verdict = |code| language.name("paper_verdict", code).to_owned();
    let number = |it: u64| it.to_string();
    let members = [
        ("paper-lot", filter.lot.clone()),
        ("paper-run", filter.run.map(|it| it.to_string())),
        ("paper-since", filter.since.map(|it| paper.time(it))),
        ("paper-until", filter.until.map(|it| paper.time(it))),
        ("paper-verdict", filter.verdict.as_deref().map(verdict)),
        ("paper-bin", filter.bin.as_deref().map(name)),
        (
            "column-kind",
            filter
                .kind
                .as_deref()
                .map(|it| language.name("part_kind", it).to_owned()),
        ),
        (
            "paper-parameter",
            filter.param.as_deref().map(|it| parameter(language, it)),
        ),
        ("paper-min", filter.min.map(|it| figure(Some(it)))),
        ("paper-max", filter.max.map(|it| figure(Some(it)))),
        (
            "paper-suspect",
            filter
                .suspect
                .then(|| language.text("paper-yes_only").to_owned()),
        ),
        ("paper-first_parts", filter.limit.map(number)),
        ("paper-left_out", filter.offset.map(number)),
    ];
    let members = members
        .into_iter()
        .filter_map(|(id, text)| Some((language.text(id).to_owned(), text?)));
    let standing = match &filter.lot {
        Some(lot) => archive.external_standing(lot)?,
        None => None,
    };
    let name = language.text("paper-external").to_owned();
    let standing = standing.map(|it| (name, external_sentence(language, &it)));
    let answers = match filter.lot {
        Some(_) => archive.answers(filter)?,
        None => Vec::new(),
    };
    let prompt = language.text("paper-prompt");
    let answers = answers.into_iter().map(|it| {
        let said = [it.choice, it.who, paper.time(it.at)];
        let name = format!("{prompt}{}{}", language.colon(), it.prompt);
        (name, said.join(language.comma()))
    });
    let recipe = language.text("paper-recipe").to_owned();
    Ok([(recipe, recipes.join(", "))]
        .into_iter()
        .chain(members)
        .chain(standing)
        .chain(answers)
        .collect())
}
