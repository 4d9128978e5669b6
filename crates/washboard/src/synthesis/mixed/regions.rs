//! Pole regions as matrix inequalities: L ⊗ X + M ⊗ A + Mᵀ ⊗ Aᵀ ≺ 0.

use super::goals::PoleRegion;
use crate::optimize::{Expr, Lmi};

/// Adds a region's inequalities; `a` is A X of a Lyapunov matrix `x`, or both after a congruence.
///
/// Source: Chilali and Gahinet, IEEE Trans. Automat. Control 41 (1996) 358–367.
pub(super) fn add(lmi: &mut Lmi, region: &PoleRegion, a: &Expr, x: &Expr) {
    if let Some(alpha) = region.faster_than {
        lmi.negative("poles left of a line", &(&a.he() + &x.scaled(2.0 * alpha)));
    }
    if let Some(beta) = region.slower_than {
        lmi.positive("poles right of a line", &a.he() + &x.scaled(2.0 * beta));
    }
    if let Some(most) = region.below_frequency {
        let skew = a - &a.t();
        let diagonal = x.scaled(-2.0 * most);
        lmi.negative(
            "poles in a strip",
            &Expr::symmetric(vec![vec![diagonal.clone(), skew], vec![diagonal]]),
        );
    }
    if let Some(radius) = region.within {
        let diagonal = x.scaled(-radius);
        lmi.negative(
            "poles in a disk",
            &Expr::symmetric(vec![vec![diagonal.clone(), a.clone()], vec![diagonal]]),
        );
    }
    if let Some(angle) = region.cone {
        let (even, odd) = (a.he().scaled(angle.sin()), (a - &a.t()).scaled(angle.cos()));
        lmi.negative("poles in a cone", &Expr::symmetric(vec![vec![even.clone(), odd], vec![even]]));
    }
}
