//! Differences of values from finer reference values, group by group: a table of their
//! distribution.

use dataset::{COMPARED, ComparedState, reference_rms, relative_rms};
use support::table::Table;

/// Lower bound of the scale of a group's difference, relative to the reference of all groups.
const MIN_SCALE: f64 = 0.1;

/// The definition of the scale of the differences, for the text of pages.
pub const SCALE: &str = "for all states together and for each group alone, the latter relative to at \
                         least a tenth of the value over all";

/// The difference of each group, relative to its own reference or to a tenth of the reference of
/// all groups, if larger.
fn each_relative(groups: &[&[ComparedState]]) -> Vec<[f64; 6]> {
    let min_scale = reference_rms(groups.iter().copied().flatten()).map(|rms| MIN_SCALE * rms);
    groups.iter().map(|states| relative_rms(states, min_scale)).collect()
}

/// One row per quantity: the difference over all states, and its distribution over the groups.
pub fn spread_table(groups: &[&[ComparedState]], group: &str) -> Table {
    let mut table = Table::new([
        "quantity".to_owned(),
        "all states".to_owned(),
        format!("median {group}"),
        format!("90 % of {group}s"),
        format!("worst {group}"),
    ]);
    let all = relative_rms(&groups.concat(), [0.0; 6]);
    let each = each_relative(groups);
    for (i, name) in COMPARED.iter().enumerate() {
        let known = std::iter::zip(groups, &each)
            .filter(|(states, _)| states.iter().any(|state| state.is_known(i)));
        let mut sorted: Vec<_> = known.map(|(_, rms)| rms[i]).collect();
        sorted.sort_by(f64::total_cmp);
        let Some(last) = sorted.len().checked_sub(1) else {
            table.row([name, "not known", "", "", ""]);
            continue;
        };
        let quantile = |fraction: f64| sorted[(fraction * last as f64).round() as usize];
        let [median, most, worst] = [0.5, 0.9, 1.0].map(|fraction| percent(quantile(fraction)));
        table.row([(*name).to_owned(), percent(all[i]), median, most, worst]);
    }
    table
}

/// Cuts off at 1000 %: if the reference is almost zero (damage of hinges that do not yield), the
/// ratio is meaningless.
fn percent(relative: f64) -> String {
    if relative < 10.0 { format!("{:.2} %", 100.0 * relative) } else { "over 1000 %".into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_to_an_almost_zero_reference_are_cut_off() {
        assert_eq!(percent(0.01234), "1.23 %");
        assert_eq!(percent(5e286), "over 1000 %");
        assert_eq!(percent(f64::NAN), "over 1000 %");
    }
}
