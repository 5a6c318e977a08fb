//! The default engine: the feature's displacement from its base, turned with the surface, added to the target.
//!
//! No system is solved besides the bases. Weights multiply, so that they stay positive.

use super::block::{Block, Point, euclidean};

/// New points of the feature's control points, in the order of the block's mask.
pub(super) fn displaced(block: &Block) -> Vec<Point> {
    let own = block.own.indices().zip(&block.carries);
    own.map(|(at, carry)| {
        let (source, base, target) = (&block.source[at], &block.source_base[at], &block.target_base[at]);
        let moved = euclidean(target) + carry * (euclidean(source) - euclidean(base));
        let weight = target[3] * source[3] / base[3];
        [weight * moved.x, weight * moved.y, weight * moved.z, weight]
    })
    .collect()
}
