//! Interpolation with straight lines between the entries of a table.

/// The entries around `x` of a table, whose positions increase, and the fraction of the way from
/// the first to the second; outside of the table its end, twice.
///
/// # Panics
/// If the table is empty.
pub fn piece<T>(table: &[T], position: impl Fn(&T) -> f64, x: f64) -> (&T, &T, f64) {
    let after = table.partition_point(|entry| position(entry) < x);
    let (from, to) = (&table[after.saturating_sub(1)], &table[after.min(table.len() - 1)]);
    let [begin, end] = [from, to].map(&position);
    (from, to, if end > begin { (x - begin) / (end - begin) } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::piece;

    #[test]
    fn a_position_is_between_its_neighbours_or_at_an_end() {
        let table = [(0.0, 'a'), (1.0, 'b'), (3.0, 'c')];
        let at = |x| {
            let (from, to, fraction) = piece(&table, |entry| entry.0, x);
            (from.1, to.1, fraction)
        };
        assert_eq!(at(2.0), ('b', 'c', 0.5));
        assert_eq!(at(1.0), ('a', 'b', 1.0));
        assert_eq!([at(-1.0), at(0.0)], [('a', 'a', 1.0); 2]);
        assert_eq!(at(4.0), ('c', 'c', 1.0));
    }
}
