# SPDX-License-Identifier: GPL-3.0-or-later
# Rscript expected.R samples.csv > expected.csv: what R's own functions, and formulae on its distributions, give for the samples.
# Cliff's delta is computed pair by pair [Cliff1993]; R has no function of its own for it, nor for Dunn's test [Dunn1964].
samples <- read.csv(commandArgs(TRUE)[1])
s <- split(samples$value, samples$sample)
say <- function(name, value) cat(sprintf("%s,%.17g\n", name, value), sep = "")
cat("name,value\n")
inverted <- function(p, share, low, high) uniroot(function(x) p(x) - share, c(low, high), tol = 1e-13, maxiter = 10000)$root

for (name in names(s)) {
  x <- s[[name]]
  q <- quantile(x, c(.25, .5, .75))
  t <- t.test(x)
  say(paste0("summary.", name, ".", c("mean", "sd", "q1", "median", "q3", "low", "high")),
      c(mean(x), sd(x), q, t$conf.int[1:2]))
}
noncentral <- function(t, df) c(inverted(function(d) suppressWarnings(pt(t, df, d)), .975, t - 30, t + 5),
                                inverted(function(d) suppressWarnings(pt(t, df, d)), .025, t - 5, t + 30))
for (pair in list(c("a", "b"), c("c", "d"), c("e", "f"))) {
  x <- s[[pair[1]]]; y <- s[[pair[2]]]; n <- length(x)
  t <- t.test(y, x, paired = TRUE)
  d <- noncentral(t$statistic, n - 1) / sqrt(n)
  say(paste0("paired.", pair[1], pair[2], ".", c("t", "df", "p", "difference", "low", "high", "d", "d_low", "d_high")),
      c(t$statistic, t$parameter, t$p.value, t$estimate, t$conf.int[1:2], t$statistic / sqrt(n), d))
  w <- suppressWarnings(wilcox.test(y, x, paired = TRUE))
  v <- w$statistic; k <- sum(x != y)
  say(paste0("signed.", pair[1], pair[2], ".", c("v", "p", "r")), c(v, w$p.value, (2 * v - k * (k + 1) / 2) / (k * (k + 1) / 2)))
}
cliff <- function(x, y) {
  m <- length(x); n <- length(y); d <- outer(x, y, function(a, b) sign(b - a)); e <- mean(d); z <- qnorm(.975)
  if (abs(e) == 1) { k <- min(m, n); return(c(e, sort(c(e, e * (k - z^2) / (k + z^2))))) }
  v <- (n^2 * sum((rowMeans(d) - e)^2) + m^2 * sum((colMeans(d) - e)^2) - sum((d - e)^2)) / (m * n * (m - 1) * (n - 1))
  v <- max(v, (1 - e^2) / (m * n - 1))
  h <- z * sqrt(v) * sqrt((1 - e^2)^2 + z^2 * v)
  c(e, max(-1, (e - e^3 - h) / (1 - e^2 + z^2 * v)), min(1, (e - e^3 + h) / (1 - e^2 + z^2 * v)))
}
for (pair in list(c("a", "b"), c("c", "d"), c("e", "f"), c("g", "h"), c("i", "j"))) {
  x <- s[[pair[1]]]; y <- s[[pair[2]]]; m <- length(x); n <- length(y)
  t <- t.test(y, x)
  pooled <- sqrt(((m - 1) * var(x) + (n - 1) * var(y)) / (m + n - 2)); root <- sqrt(m * n / (m + n))
  d <- (mean(y) - mean(x)) / pooled
  say(paste0("welch.", pair[1], pair[2], ".", c("t", "df", "p", "difference", "low", "high", "d", "d_low", "d_high")),
      c(t$statistic, t$parameter, t$p.value, mean(y) - mean(x), t$conf.int[1:2], d, noncentral(d * root, m + n - 2) / root))
  w <- suppressWarnings(wilcox.test(y, x))
  say(paste0("mann.", pair[1], pair[2], ".", c("u", "p", "delta", "delta_low", "delta_high")), c(w$statistic, w$p.value, cliff(x, y)))
}
for (groups in list(c("a", "b", "e"), c("c", "d", "i"), c("g", "h"), c("a", "f", "i", "j"))) {
  g <- s[groups]; name <- paste(groups, collapse = ""); all <- unlist(g); n <- length(all)
  k <- kruskal.test(g)
  lambda <- function(share) { p <- function(l) pchisq(k$statistic, k$parameter, l)
    if (p(0) <= share) 0 else inverted(p, share, 0, 500) }
  say(paste0("kruskal.", name, ".", c("h", "df", "p", "epsilon", "epsilon_low", "epsilon_high")),
      c(k$statistic, k$parameter, k$p.value, k$statistic / (n - 1), lambda(.975) / (n - 1), min(1, lambda(.025) / (n - 1))))
  r <- split(rank(all), rep(seq_along(g), lengths(g))); t <- table(all)
  spread <- n * (n + 1) / 12 - sum(t^3 - t) / (12 * (n - 1))
  z <- c()
  for (i in seq_along(g)) for (j in seq_along(g)) if (i < j)
    z <- c(z, (mean(r[[j]]) - mean(r[[i]])) / sqrt(spread * (1 / length(r[[i]]) + 1 / length(r[[j]]))))
  p <- 2 * pnorm(-abs(z))
  say(paste0("dunn.", name, ".z", seq_along(z)), z)
  say(paste0("dunn.", name, ".p", seq_along(z)), p)
  say(paste0("dunn.", name, ".holm", seq_along(z)), p.adjust(p, "holm"))
  say(paste0("dunn.", name, ".bonferroni", seq_along(z)), p.adjust(p, "bonferroni"))
}
# Table XVI of the dissertation: acceptable screws of A, B, C.
some <- c(17, 20, 24); all <- c(26, 24, 26)
for (i in 1:3) {
  ci <- prop.test(some[i], all[i], correct = FALSE)$conf.int
  say(paste0("share.", i, ".", c("low", "high")), ci[1:2])
}
for (pair in list(c(1, 2), c(1, 3), c(2, 3)))
  say(paste0("fisher.", pair[1], pair[2]), fisher.test(rbind(c(some[pair[1]], all[pair[1]] - some[pair[1]]), c(some[pair[2]], all[pair[2]] - some[pair[2]])))$p.value)
