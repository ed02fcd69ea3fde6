//! Methods of iterators over numbers and texts.

use std::borrow::Borrow;

/// The extremes of numbers.
pub trait Extremes: Iterator + Sized {
    /// The largest number; zero if none is positive.
    fn largest(self) -> f64
    where
        Self: Iterator<Item = f64>,
    {
        self.fold(0.0, f64::max)
    }

    /// The smallest number; infinite if there is none.
    fn smallest(self) -> f64
    where
        Self: Iterator<Item = f64>,
    {
        self.fold(f64::INFINITY, f64::min)
    }

    /// The last item with the largest number.
    fn largest_by(self, number: impl Fn(&Self::Item) -> f64) -> Option<Self::Item> {
        self.max_by(|one, other| number(one).total_cmp(&number(other)))
    }

    /// The first item with the smallest number.
    fn smallest_by(self, number: impl Fn(&Self::Item) -> f64) -> Option<Self::Item> {
        self.min_by(|one, other| number(one).total_cmp(&number(other)))
    }
}

impl<I: Iterator> Extremes for I {}

/// Texts in a row.
pub trait Joined: Iterator<Item: Borrow<str>> + Sized {
    /// The texts with `between` between them.
    fn joined(self, between: &str) -> String {
        self.collect::<Vec<_>>().join(between)
    }
}

impl<I: Iterator<Item: Borrow<str>>> Joined for I {}
