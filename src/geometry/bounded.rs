//! Curves made of pieces of curves: trimmed and composite ones, in space and in the plane alike.
//!
//! Holds the change of parameter only: which piece a parameter falls on, where on it, and in which sense.
//! Points and derivatives are the business of the curves themselves.

/// A piece of a curve: ISO 10303-42 `trimmed_curve`.
///
/// Where the senses agree the parameter is the basis curve's; else its negative, so that the domain ascends
/// while the piece runs backwards.
#[derive(Debug, Clone, PartialEq)]
pub struct Trimmed<C> {
    /// The curve that is trimmed.
    pub basis: Box<C>,
    /// Least parameter of the piece on the basis curve.
    pub start: f64,
    /// Greatest parameter of the piece on the basis curve; on a closed curve up to a period past its domain.
    pub end: f64,
    /// Whether the piece runs as its basis does.
    pub forward: bool,
}

impl<C> Trimmed<C> {
    /// First and last parameter.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        if self.forward { (self.start, self.end) } else { (-self.end, -self.start) }
    }

    /// The parameter on the basis curve, and its derivative: 1 or -1.
    #[must_use]
    pub fn locate(&self, t: f64) -> (f64, f64) {
        if self.forward { (t, 1.0) } else { (-t, -1.0) }
    }

    /// The parameter of a point of the basis curve, moved into the piece: by whole periods of the basis where
    /// it has one, else to the nearer end.
    #[must_use]
    pub fn parameter_of(&self, on_basis: f64, period: Option<f64>) -> f64 {
        let middle = 0.5 * (self.start + self.end);
        let near = period.map_or(on_basis, |p| on_basis + p * ((middle - on_basis) / p).round());
        let held = near.clamp(self.start, self.end);
        if self.forward { held } else { -held }
    }
}

/// Curves end to end: ISO 10303-42 `composite_curve`.
///
/// The parameter starts at zero and grows by the length of each segment's own interval.
///
/// INVARIANT: one segment at least, and every interval is finite and longer than zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Composite<C> {
    segments: Vec<Segment<C>>,
    /// Parameters where segments begin, and the end of the last.
    breaks: Vec<f64>,
}

/// One curve of a composite.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment<C> {
    /// The curve, bounded or closed.
    pub curve: C,
    /// Its domain.
    pub domain: (f64, f64),
    /// Whether the composite runs as the segment does.
    pub forward: bool,
}

impl<C> Composite<C> {
    /// Joins segments; `None` when there is none, or one has no finite interval.
    #[must_use]
    pub fn new(segments: Vec<Segment<C>>) -> Option<Self> {
        let mut breaks = vec![0.0];
        let mut end = 0.0;
        for segment in &segments {
            let length = segment.domain.1 - segment.domain.0;
            if !(length > 0.0 && length.is_finite()) {
                return None;
            }
            end += length;
            breaks.push(end);
        }
        (!segments.is_empty() && end.is_finite()).then_some(Self { segments, breaks })
    }

    /// The segments in order.
    #[must_use]
    pub fn segments(&self) -> &[Segment<C>] {
        &self.segments
    }

    /// Parameters where segments begin, and the end of the last.
    #[must_use]
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// First and last parameter.
    #[must_use]
    pub fn domain(&self) -> (f64, f64) {
        (0.0, self.breaks[self.segments.len()])
    }

    /// The curve under a parameter, the parameter on it, and its derivative: 1 or -1. Past the ends the first
    /// and the last segment go on.
    #[must_use]
    pub fn locate(&self, t: f64) -> (&C, f64, f64) {
        let at = self.breaks.partition_point(|&b| b <= t).clamp(1, self.segments.len()) - 1;
        let segment = &self.segments[at];
        let into = t - self.breaks[at];
        if segment.forward {
            (&segment.curve, segment.domain.0 + into, 1.0)
        } else {
            (&segment.curve, segment.domain.1 - into, -1.0)
        }
    }

    /// The composite's parameter of a parameter on one of its segments.
    #[must_use]
    pub fn parameter_on(&self, segment: usize, t: f64) -> f64 {
        let of = &self.segments[segment];
        let held = t.clamp(of.domain.0, of.domain.1);
        self.breaks[segment] + if of.forward { held - of.domain.0 } else { of.domain.1 - held }
    }

    /// The composite of other curves, segment by segment; `None` as [`new`](Self::new).
    ///
    /// # Errors
    /// What `change` fails with.
    pub fn try_map<E>(&self, change: impl Fn(&C) -> Result<C, E>) -> Result<Self, E>
    where
        C: Clone,
    {
        let mut segments = Vec::with_capacity(self.segments.len());
        for segment in &self.segments {
            segments.push(Segment { curve: change(&segment.curve)?, ..segment.clone() });
        }
        Ok(Self { segments, breaks: self.breaks.clone() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_backward_piece_runs_from_its_end_to_its_start() {
        let piece = Trimmed { basis: Box::new(()), start: 2.0, end: 5.0, forward: false };
        assert_eq!(piece.domain(), (-5.0, -2.0));
        assert_eq!(piece.locate(-5.0), (5.0, -1.0));
        assert_eq!(piece.parameter_of(4.0, None).to_bits(), (-4.0f64).to_bits());
        // Outside: the nearer end; with a period of 4 the parameter 8.5 is 4.5 again.
        assert_eq!(piece.parameter_of(9.0, None).to_bits(), (-5.0f64).to_bits());
        assert_eq!(piece.parameter_of(8.5, Some(4.0)).to_bits(), (-4.5f64).to_bits());
    }

    #[test]
    fn a_composite_counts_through_its_segments() {
        let segments = vec![
            Segment { curve: 'a', domain: (1.0, 3.0), forward: true },
            Segment { curve: 'b', domain: (0.0, 1.0), forward: false },
        ];
        let whole = Composite::new(segments).expect("two good segments");
        assert_eq!(whole.domain(), (0.0, 3.0));
        assert_eq!(whole.locate(0.5), (&'a', 1.5, 1.0));
        assert_eq!(whole.locate(2.25), (&'b', 0.75, -1.0));
        assert_eq!(whole.locate(3.0), (&'b', 0.0, -1.0));
        assert_eq!(whole.parameter_on(1, 0.75).to_bits(), 2.25f64.to_bits());
        assert!(Composite::<char>::new(Vec::new()).is_none());
        assert!(
            Composite::new(vec![Segment { curve: 'c', domain: (0.0, f64::INFINITY), forward: true }])
                .is_none()
        );
    }
}
