//! Differences of values from finer reference values, group by group: a table of their distribution.

use dataset::{COMPARED, ComparedState, reference_rms, relative_rms};
use support::table::{Cell, Table};

/// Lower bound of the scale of a group's difference, relative to the reference of all groups.
const MIN_SCALE: f64 = 0.1;

/// The definition of the scale of the differences, for the text of pages.
pub const SCALE: &str = "for all states together and for each group alone, the latter relative to at \
                         least a tenth of the value over all";

/// The difference of each group, relative to its own reference or to a tenth of that of all groups, if larger.
pub fn each_relative(groups: &[&[ComparedState]]) -> Vec<[f64; 6]> {
    let min_scale = reference_rms(groups.iter().copied().flatten()).map(|rms| MIN_SCALE * rms);
    groups
        .iter()
        .map(|states| relative_rms(states, min_scale))
        .collect()
}

/// One row per quantity: the difference over all states, and its distribution over the groups.
pub fn spread_table(groups: &[&[ComparedState]], group: &str) -> String {
    let all = relative_rms(&groups.concat(), [0.0; 6]);
    let each = each_relative(groups);
    // The differences of a quantity over the groups that know it, in ascending order.
    let known = |i: usize| {
        let groups = std::iter::zip(groups, &each);
        let known = groups.filter(|(states, _)| states.iter().any(|state| state.is_known(i)));
        let mut sorted: Vec<f64> = known.map(|(_, rms)| rms[i]).collect();
        sorted.sort_by(f64::total_cmp);
        sorted
    };
    let sorted: [Vec<f64>; 6] = std::array::from_fn(known);
    let quantile = |i: usize, fraction: f64| {
        let last = sorted[i].len().checked_sub(1);
        let place = last.map(|last| (fraction * last as f64).round() as usize);
        Cell::text(place.map_or(String::new(), |place| percent(sorted[i][place])))
    };
    let table = Table::new()
        .column("quantity", |i: &usize| Cell::text(COMPARED[*i]))
        .column("all states", |i| {
            let known = !sorted[*i].is_empty();
            Cell::text(if known {
                percent(all[*i])
            } else {
                "not known".into()
            })
        })
        .column(format!("median {group}"), |i| quantile(*i, 0.5))
        .column(format!("90 % of {group}s"), |i| quantile(*i, 0.9))
        .column(format!("worst {group}"), |i| quantile(*i, 1.0));
    table.markdown(&[0, 1, 2, 3, 4, 5])
}

/// Cuts off at 1000 %: if the reference is almost zero (damage of hinges that do not yield), the ratio is meaningless.
fn percent(relative: f64) -> String {
    if relative < 10.0 {
        format!("{:.2} %", 100.0 * relative)
    } else {
        "over 1000 %".into()
    }
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
