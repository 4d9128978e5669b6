//! Programs made with their answer, and programs that have none.

use super::sdplib::assert_optimal;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use washboard::linalg::Mat;
use washboard::optimize::{Atom, Block, Sdp, SdpError, SdpSettings, Status};

fn random(rng: &mut ChaCha8Rng, n: usize, m: usize) -> Mat {
    Mat::from_fn(n, m, |_, _| rng.random_range(-1.0..1.0))
}

fn coefficient(block: &Block, variable: usize) -> Mat {
    let n = block.size();
    let mut f = Mat::zeros(n, n);
    for a in block.atoms.iter().filter(|a| a.variable == variable) {
        let (l, r) = (block.vectors.col(a.left), block.vectors.col(a.right));
        for j in 0..n {
            for i in 0..n {
                f[(i, j)] += a.coefficient * (l[i] * r[j] + r[i] * l[j]);
            }
        }
    }
    f
}

fn inner(a: &Mat, b: &Mat) -> f64 {
    (0..a.ncols()).map(|j| (0..a.nrows()).map(|i| a[(i, j)] * b[(i, j)]).sum::<f64>()).sum()
}

/// min cᵀx with F(x*) = Q diag(s, 0)Qᵀ and Z* = Q diag(0, z)Qᵀ: x* is optimal.
fn with_known_optimum(seed: u64, variables: usize, sizes: &[usize]) -> (Sdp, f64, Vec<Block>, Vec<f64>) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let x: Vec<f64> = (0..variables).map(|_| rng.random_range(-1.0..1.0)).collect();
    let mut objective = vec![0.0; variables];
    let mut blocks = Vec::new();
    for &n in sizes {
        let vectors = random(&mut rng, n, 2 * n);
        let atoms = (0..variables)
            .flat_map(|variable| {
                let rng = &mut rng;
                (0..3)
                    .map(|_| Atom {
                        variable,
                        left: rng.random_range(0..2 * n),
                        right: rng.random_range(0..2 * n),
                        coefficient: rng.random_range(-1.0..1.0),
                    })
                    .collect::<Vec<_>>()
            })
            .collect();
        let mut block = Block { constant: Mat::zeros(n, n), vectors, atoms };
        let q = random(&mut rng, n, n).qr().compute_Q();
        let rank = n / 2;
        let spread = |rng: &mut ChaCha8Rng, keep: &dyn Fn(usize) -> bool| {
            let d: Vec<f64> =
                (0..n).map(|i| if keep(i) { rng.random_range(0.5..2.0) } else { 0.0 }).collect();
            &q * Mat::from_fn(n, n, |i, j| if i == j { d[i] } else { 0.0 }) * q.transpose()
        };
        let (s, z) = (spread(&mut rng, &|i| i < rank), spread(&mut rng, &|i| i >= rank));
        let mut constant = s;
        for (i, x) in x.iter().enumerate() {
            let f = coefficient(&block, i);
            objective[i] += inner(&f, &z);
            constant -= Mat::from_fn(n, n, |a, b| x * f[(a, b)]);
        }
        block.constant = Mat::from_fn(n, n, |i, j| 0.5 * (constant[(i, j)] + constant[(j, i)]));
        blocks.push(block);
    }
    let value = objective.iter().zip(&x).map(|(c, x)| c * x).sum();
    (Sdp::new(objective.clone(), blocks.clone()).unwrap(), value, blocks, objective)
}

#[test]
fn random_programs_with_a_known_optimum() {
    for seed in 0..12 {
        let (variables, sizes) =
            ([4, 10, 25, 60][seed as usize % 4], [[3, 5, 1], [8, 12, 2], [15, 1, 9]][seed as usize % 3]);
        let (sdp, value, ..) = with_known_optimum(seed, variables.min(30 * (1 + seed as usize % 3)), &sizes);
        let o = sdp.solve(&SdpSettings::default());
        assert_optimal(&format!("seed {seed}"), &sdp, &o);
        assert!(
            (o.objective - value).abs() <= 1e-6 * (1.0 + value.abs()),
            "seed {seed}: {} for {value}",
            o.objective
        );
    }
}

/// TᵀF(x)T ⪰ 0 says what F(x) ⪰ 0 says.
#[test]
fn congruence_changes_nothing() {
    let (sdp, value, mut blocks, objective) = with_known_optimum(5, 12, &[6, 8]);
    let mut rng = ChaCha8Rng::seed_from_u64(77);
    for b in &mut blocks {
        let n = b.size();
        let t = random(&mut rng, n, n)
            + Mat::from_fn(n, n, |i, j| if i == j { 10f64.powi(i as i32 % 3) } else { 0.0 });
        let c = t.transpose() * &b.constant * &t;
        b.constant = Mat::from_fn(n, n, |i, j| 0.5 * (c[(i, j)] + c[(j, i)]));
        b.vectors = t.transpose() * &b.vectors;
    }
    let other = Sdp::new(objective, blocks).unwrap();
    let (a, b) = (sdp.solve(&SdpSettings::default()), other.solve(&SdpSettings::default()));
    assert!((a.objective - value).abs() <= 1e-6 * (1.0 + value.abs()));
    assert!(
        (a.objective - b.objective).abs() <= 1e-6 * (1.0 + value.abs()),
        "{} and {}",
        a.objective,
        b.objective
    );
}

/// The same bits on one thread and on three.
#[test]
fn threads_change_nothing() {
    let (sdp, ..) = with_known_optimum(3, 40, &[20, 30]);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| sdp.solve(&SdpSettings::default()))
    };
    let (one, three) = (on(1), on(3));
    assert_eq!(one.x, three.x);
    assert_eq!(one.iterations, three.iterations);
}

/// x ≥ 1 and x ≤ −1: a Z with F•Z = 0 and F₀•Z < 0 proves that there is no x.
#[test]
fn an_infeasible_program_is_proved() {
    let one = |value: f64| Mat::from_fn(1, 1, |_, _| value);
    let blocks = vec![
        Block::from_entries(one(-1.0), &[(0, 0, 0, 1.0)]),
        Block::from_entries(one(-1.0), &[(0, 0, 0, -1.0)]),
    ];
    let o = Sdp::new(vec![1.0], blocks).unwrap().solve(&SdpSettings::default());
    assert_eq!(o.status, Status::Infeasible);
    let [up, down] = [&o.multiplier[0], &o.multiplier[1]].map(|z| z[(0, 0)]);
    assert!(up > 0.0 && down > 0.0 && (up - down).abs() <= 1e-7 * up, "{up} {down}");
    let proof = o.certificate.unwrap();
    assert!(proof.violation <= 1e-7 && (proof.value - (up + down)).abs() <= 1e-12 * proof.value, "{proof:?}");
}

/// min −x over [[1, 0], [0, x]] ⪰ 0.
#[test]
fn an_unbounded_program_has_a_direction() {
    let constant = Mat::from_fn(2, 2, |i, j| if i == 0 && j == 0 { 1.0 } else { 0.0 });
    let sdp = Sdp::new(vec![-1.0], vec![Block::from_entries(constant, &[(0, 1, 1, 1.0)])]).unwrap();
    let o = sdp.solve(&SdpSettings::default());
    assert_eq!(o.status, Status::Unbounded);
    assert!(o.x[0] > 0.0 && o.certificate.unwrap().violation <= 1e-8, "{o:?}");
}

/// [[x, 1], [1, y]] ⪰ 0, min x: the infimum 0 is not attained. No answer that is called one may be wrong by more than it
/// says.
#[test]
fn an_infimum_that_is_not_attained_is_approached() {
    let constant = Mat::from_fn(2, 2, |i, j| if i == j { 0.0 } else { 1.0 });
    let block = Block::from_entries(constant, &[(0, 0, 0, 1.0), (1, 1, 1, 1.0)]);
    let sdp = Sdp::new(vec![1.0, 0.0], vec![block]).unwrap();
    let o = sdp.solve(&SdpSettings::default());
    assert!(matches!(o.status, Status::Optimal | Status::Stalled), "{:?}", o.status);
    assert!(o.objective.abs() < 1e-3, "{o:?}");
}

#[test]
fn what_does_not_fit_is_named() {
    let square = |n: usize| Mat::identity(n, n);
    let atom = Atom { variable: 0, left: 0, right: 0, coefficient: 1.0 };
    let block = |constant: Mat, vectors: Mat, atom: Atom| Block { constant, vectors, atoms: vec![atom] };
    let refused = |objective: Vec<f64>, b: Vec<Block>| Sdp::new(objective, b).unwrap_err().to_string();
    assert!(matches!(Sdp::new(vec![], vec![]), Err(SdpError::Empty { variables: 0, blocks: 0 })));
    let text = refused(vec![f64::NAN], vec![block(square(2), square(2), atom)]);
    assert!(text.contains("objective[0] is NaN"), "{text}");
    let text = refused(vec![1.0], vec![block(square(2), square(3), atom)]);
    assert!(text.contains("block 0: the vectors: expected 2 rows, found 3 rows"), "{text}");
    let text = refused(vec![1.0], vec![block(square(2), square(2), Atom { variable: 4, ..atom })]);
    assert!(text.contains("a variable: expected below 1, found 4"), "{text}");
    let text = refused(vec![1.0], vec![block(square(2), square(2), Atom { right: 2, ..atom })]);
    assert!(text.contains("a vector: expected below 2, found 2"), "{text}");
    let skew = Mat::from_fn(2, 2, |i, j| if i < j { 1.0 } else { 0.0 });
    let text = refused(vec![1.0], vec![block(skew, square(2), atom)]);
    assert!(text.contains("expected symmetry"), "{text}");
}
