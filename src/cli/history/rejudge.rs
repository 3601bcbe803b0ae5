//! `history rejudge`: what another recipe would have said. The history stays as it is.

use super::output::{Output, Table};
use crate::config::load_recipe;
use crate::gauge::Recipe;
use crate::history::{Archive, Basis, Filter, rejudged};
use clap::Args;
use serde_json::json;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

#[derive(Debug, Args)]
pub(super) struct RejudgeArgs {
    /// Name of the lot
    #[arg(long, value_name = "LOT")]
    lot: String,
    /// Only this run of the lot (1, 2, ...)
    #[arg(long, value_name = "N")]
    run: Option<u32>,
    /// Recipe in config/recipes to judge by
    #[arg(long, value_name = "NAME")]
    recipe: String,
    /// One JSON object per part, then a summary
    #[arg(long)]
    json: bool,
}

pub(super) fn run(config: &Path, archive: &Archive, args: &RejudgeArgs) -> anyhow::Result<()> {
    let recipe = load_recipe(config, &args.recipe)?;
    let filter = Filter {
        lot: Some(args.lot.clone()),
        run: args.run,
        ..Filter::default()
    };
    anyhow::ensure!(
        archive.how_many(&filter)? > 0,
        "lot {:?} has no parts (or no such run); see `history list`",
        args.lot
    );
    let same = Basis::of_recipe(&recipe);
    let basis = bases(archive, &filter, &recipe)?;
    let mut out = Output::stdout();
    let mut table = Table::new(&["run", "seq", "verdict", "now", "bin", "reasons"]);
    let mut counts: BTreeMap<(String, &str), u64> = BTreeMap::new();
    archive.each(&filter, |part| {
        let basis = basis.get(&part.run).copied();
        let curves = archive.curves(&part)?;
        let verdict = rejudged(&part, &curves, basis.unwrap_or(same), &recipe);
        let now = verdict.name();
        *counts.entry((part.verdict.clone(), now)).or_default() += 1;
        let (bin, reasons) = (verdict.bin().name(), verdict.reasons());
        if args.json {
            return out.json(&json!({
                "type": "part", "lot": part.lot, "run": part.run, "seq": part.seq,
                "recipe": recipe.name, "verdict_was": part.verdict, "verdict": now, "bin": bin,
                "reasons": reasons,
            }));
        }
        if part.verdict != now {
            let (run, seq) = (part.run.to_string(), part.seq.to_string());
            let row = vec![
                run,
                seq,
                part.verdict,
                now.into(),
                bin.into(),
                reasons.join("; "),
            ];
            table.row(&mut out, row)?;
        }
        Ok(())
    })??;
    if args.json {
        let change =
            |((was, now), n): (&(String, &str), &u64)| json!({"was": was, "now": now, "parts": n});
        let changes: Vec<_> = counts.iter().map(change).collect();
        out.json(&json!({"type": "summary", "recipe": recipe.name, "recipe_hash": recipe.hash, "changes": changes}))?;
        return Ok(out.flush()?);
    }
    table.finish(&mut out)?;
    for ((was, now), n) in &counts {
        writeln!(out, "{was} -> {now}: {n}")?;
    }
    Ok(out.flush()?)
}

/// What the values of each run refer to; an import without a recipe is taken to refer to the same.
fn bases(
    archive: &Archive,
    filter: &Filter,
    recipe: &Recipe,
) -> anyhow::Result<BTreeMap<u32, Basis>> {
    let mut bases = BTreeMap::new();
    for run in archive.lots(filter)? {
        let text = archive.recipe(&run.recipe_hash)?;
        let Some(basis) = text.as_deref().and_then(Basis::of) else {
            continue;
        };
        anyhow::ensure!(
            basis.fits(recipe),
            "--recipe {}: its coil has {} V, run {} of lot {:?} was measured at {} V",
            recipe.name,
            recipe.part.nominal_v,
            run.run,
            run.lot,
            basis.nominal_v
        );
        bases.insert(run.run, basis);
    }
    Ok(bases)
}
