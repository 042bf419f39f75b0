//! What a user is told where numbers are left out.

/// How many of `total` pieces have no `what`, and why the first has none; `None` where all have it.
/// `left_out` holds names and reasons.
pub(super) fn left_out(
    pieces: &str,
    total: usize,
    what: &str,
    left_out: &[(String, String)],
) -> Option<String> {
    let (first, reason) = left_out.first()?;
    let count = left_out.len();
    Some(format!(
        "{count} of {total} {pieces} have no {what}: the first, {first}, because {reason}"
    ))
}
