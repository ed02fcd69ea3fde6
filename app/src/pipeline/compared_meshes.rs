//! The differences of a mesh from a finer one on the same rays.

use crate::train::correction;
use anyhow::{Result, ensure};
use dataset::{ComparedRay, ComparedState, Database, compare, left_out};
use support::document::Document;
use verification::{SCALE, spread_table};

/// Compares the rays of a database with the same rays in a reference, or else on its own finer
/// mesh; also what a training leaves, which corrects the rays to the finer mesh.
pub fn compared_meshes(database: &Database, reference: Option<&Database>) -> Result<Document> {
    let (rays, finer) = match reference {
        Some(reference) => (compare(database, reference), reference.manifest().tier.to_string()),
        None => {
            let finer = database.manifest().finer.as_ref();
            let finer = finer.map_or(String::new(), |finer| finer.tier.to_string());
            (database.on_both_meshes(), finer)
        }
    };
    ensure!(
        !rays.is_empty(),
        "the database has no ray on a finer mesh, or in common with the reference"
    );
    let states: Vec<_> = rays.iter().map(ComparedRay::states).collect();
    let mut page = summary(&rays, &states, &[database.manifest().tier.to_string(), finer]);
    match left_out(&rays) {
        Ok(checked) => page.append(correction(&checked)),
        // The comparison is valid without it.
        Err(reason) => {
            eprintln!("cannot evaluate what a correction would leave: {reason}")
        }
    }
    Ok(page)
}

/// One row per quantity: the difference over all states, and its distribution over the rays.
fn summary(
    rays: &[ComparedRay],
    states: &[Vec<ComparedState>],
    [tier, reference]: &[String; 2],
) -> Document {
    let count = states.iter().map(Vec::len).sum::<usize>();
    let cpu = |of: fn(&ComparedRay) -> f64| rays.iter().map(of).sum::<f64>() / rays.len() as f64;
    let mut page = Document::default();
    page.heading(2, format!("Tier {tier} against tier {reference}, over all common states"));
    page.text(format!(
        "{count} states of {} rays, {:.1} and {:.1} CPU s per ray. Differences are root mean squares relative \
         to the root mean square of the tier {reference}: {SCALE}. `kirigami dataset compare`.",
        rays.len(),
        cpu(|it| it.ray.cpu_s),
        cpu(|it| it.reference_cpu_s),
    ));
    let groups: Vec<_> = states.iter().map(Vec::as_slice).collect();
    page.table(spread_table(&groups, "ray"));
    page
}
