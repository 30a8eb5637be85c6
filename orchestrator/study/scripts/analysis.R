# Computes the figures of results.csv again, from ratings.csv, with R; prints both and ends with status 1 where they differ.
# Needs the packages ordinal, psych and BradleyTerry2.   Rscript analysis.R [FOLDER]
suppressPackageStartupMessages({ library(ordinal); library(psych); library(BradleyTerry2) })
folder <- commandArgs(trailingOnly = TRUE)
folder <- if (length(folder) > 0) folder[[1]] else "."
ratings <- read.csv(file.path(folder, "ratings.csv"), colClasses = c(participant = "character", film = "character"))
if (any(ratings[["simulated"]] == 1)) cat("SIMULATED ANSWERS: no person took part.\n")
ours <- read.csv(file.path(folder, "results.csv"), colClasses = c(which = "character"))
planners <- readLines(file.path(folder, "planners.txt"))
ratings <- ratings[ratings$excluded == 0, ]
# The optimizer that clmm takes by itself stops after 150 steps without a word, far from the maximum where answers have many levels.
closely <- clmm.control(method = "ucminf", grtol = 1e-6, innerCtrl = "noWarn")
# A cumulative mixed model from near its maximum on: Newton's steps with second derivatives by a complex step, integrals by trapezoids.
# The errors of clmm are second differences with a step of 0.0001, which is too wide where thresholds lie close together, and its nodes are
# too few where people differ by more than 4 logits.
exactly <- function(answer, columns, person, thresholds, effects, sigma) {
  cuts <- length(thresholds); level <- as.integer(answer); person <- as.integer(factor(person)); count <- length(effects)
  own <- outer(seq_len(max(person)), person, "==") + 0
  step <- min(0.5 / sqrt(1 + sigma^2 * max(rowSums(own)) / 2), 0.1)
  v <- seq(-10, 10, by = step)
  has_sigma <- sigma >= 1e-3
  below <- function(x) 1 / (1 + exp(-x))
  at <- c(thresholds, effects, if (has_sigma) sigma)
  slope <- function(at) {
    ends <- c(-100, at[seq_len(cuts)], 100)
    moved <- outer(as.vector(columns %*% at[cuts + seq_len(count)]), v * (if (has_sigma) at[cuts + count + 1] else 0), "+")
    upper <- ends[level + 1] - moved; lower <- ends[level] - moved
    # F(u) - F(l) = F(u) F(-l) (1 - exp(l - u)) for the logistic F, without cancellation.
    gap <- 1 - exp(ends[level] - ends[level + 1])
    weight <- exp(own %*% (log(below(upper)) + log(below(-lower)) + log(gap)) - rep(v^2 / 2, each = nrow(own)))
    value <- sum(log(rowSums(weight) * step / sqrt(2 * pi)))
    weight <- (weight / rowSums(weight))[person, , drop = FALSE]
    up <- rowSums(weight * below(-upper) / below(-lower)) / gap; down <- rowSums(weight * below(lower) / below(upper)) / gap
    shift <- weight * (below(upper) - below(-lower))
    of <- sapply(seq_len(cuts), function(cut) sum(up[level == cut]) - sum(down[level == cut + 1]))
    list(of = c(of, as.vector(t(columns) %*% rowSums(shift)), if (has_sigma) sum(shift %*% v)), value = value)
  }
  for (turn in 1:5) {
    bend <- sapply(seq_along(at), function(i) Im(slope(replace(as.complex(at), i, at[i] + 1e-20i))$of) / 1e-20)
    here <- slope(as.complex(at))
    if (turn < 5) at <- at - solve(bend, Re(here$of))
  }
  errors <- sqrt(diag(solve(-(bend + t(bend)) / 2)))
  list(effects = at[cuts + seq_len(count)], errors = errors[cuts + seq_len(count)], sigma = if (has_sigma) abs(at[cuts + count + 1]) else sigma, value = Re(here$value))
}
# Strengths with ties by Davidson: an outcome of two is a win of one, of the other, or a tie.
davidson <- function(wins, ties) {
  k <- nrow(wins); pairs <- combn(k, 2)
  minus <- function(at) {
    s <- c(0, at[seq_len(k - 1)])
    -sum(apply(pairs, 2, function(p) {
      logs <- c(s[p[1]], s[p[2]], at[k] + (s[p[1]] + s[p[2]]) / 2)
      sum(c(wins[p[1], p[2]], wins[p[2], p[1]], ties[p[1], p[2]]) * (logs - max(logs) - log(sum(exp(logs - max(logs))))))
    }))
  }
  optim(rep(0, k), minus, method = "BFGS", control = list(reltol = 1e-15, maxit = 1000, ndeps = rep(1e-4, k)))$par
}
compared <- 0
far <- 0
check <- function(scenario, dimension, statistic, which, value, by) {
  row <- ours[ours$scenario == scenario & ours$dimension == dimension & ours$statistic == statistic & ours$which == which, ]
  if (nrow(row) == 0) return(invisible())
  compared <<- compared + 1
  bad <- !is.finite(value) || abs(value - row$value) > by * max(1, abs(value))
  if (bad) far <<- far + 1
  cat(sprintf("%-12s %-22s %-20s %-16s %14.8f %14.8f %s\n", scenario, dimension, statistic, which, row$value, value, if (bad) "DIFFERS" else ""))
}
cat(sprintf("%-12s %-22s %-20s %-16s %14s %14s\n", "scenario", "dimension", "statistic", "which", "SocRATES", "R"))
for (scenario in unique(ours$scenario)) for (dimension in unique(ours$dimension[ours$scenario == scenario])) {
  part <- ratings[ratings$scenario == scenario & ratings$dimension == dimension, ]
  wide <- reshape(part[, c("participant", "film", "planner", "item", "score")], idvar = c("participant", "film", "planner"), timevar = "item", direction = "wide")
  items <- as.matrix(wide[, -(1:3), drop = FALSE])
  given <- rowSums(!is.na(items))
  wide$mean <- ifelse(given > 0 & given * 2 >= ncol(items), rowMeans(items, na.rm = TRUE), NA)
  whole <- items[complete.cases(items), , drop = FALSE]
  scores <- aggregate(mean ~ participant + planner, data = wide[!is.na(wide$mean), ], FUN = mean)
  shown <- planners[planners %in% scores$planner]
  table <- sapply(shown, function(p) scores$mean[scores$planner == p][match(unique(scores$participant), scores$participant[scores$planner == p])])
  table <- table[complete.cases(table), , drop = FALSE]
  found <- friedman.test(table)
  check(scenario, dimension, "friedman_chi2", "", unname(found$statistic), 1e-6)
  check(scenario, dimension, "friedman_p", "", found$p.value, 1e-6)
  check(scenario, dimension, "kendall_w", "", unname(found$statistic) / (nrow(table) * (ncol(table) - 1)), 1e-6)
  ranks <- t(apply(table, 1, rank))
  n <- nrow(ranks); k <- ncol(ranks); sums <- colSums(ranks); df <- (n - 1) * (k - 1)
  left <- sqrt(2 * n * (sum(ranks^2) - sum(sums^2) / n) / df)
  for (j in seq_along(shown)) for (i in seq_len(j - 1)) {
    both <- paste(shown[j], "-", shown[i])
    if (left > 1e-9) check(scenario, dimension, "conover_p", both, 2 * pt(abs(sums[j] - sums[i]) / left, df, lower.tail = FALSE), 1e-6)
    check(scenario, dimension, "nemenyi_p", both, ptukey(abs(sums[j] - sums[i]) / n / sqrt(k * (k + 1) / (12 * n)), k, Inf, lower.tail = FALSE), 1e-6)
    d <- round(table[, j] - table[, i], 9)
    kept <- d[d != 0]
    exact <- length(kept) <= 25 && length(kept) == length(d) && !anyDuplicated(abs(d))
    test <- suppressWarnings(wilcox.test(kept, exact = exact, correct = FALSE))
    check(scenario, dimension, "wilcoxon_p_dropped", paste(shown[j], "-", shown[i]), test$p.value, 1e-6)
  }
  if (ncol(whole) > 1) check(scenario, dimension, "alpha", "", suppressWarnings(psych::alpha(as.data.frame(whole), warnings = FALSE))$total$raw_alpha, 1e-6)
  if (ncol(whole) > 2) {
    fit <- tryCatch(factanal(whole, 1, control = list(opt = list(factr = 1e2))), error = function(e) NULL)
    if (!is.null(fit)) check(scenario, dimension, "omega", "", sum(fit$loadings)^2 / (sum(fit$loadings)^2 + sum(fit$uniquenesses)), 1e-4)
  }
  films <- reshape(wide[, c("participant", "film", "mean")], idvar = "participant", timevar = "film", direction = "wide")
  films <- t(as.matrix(films[complete.cases(films), -1]))
  if (ncol(films) > 1 && nrow(films) > 1) {
    a <- anova(lm(as.vector(films) ~ factor(row(films)) + factor(col(films))))[["Mean Sq"]]
    check(scenario, dimension, "icc_c1", "", (a[1] - a[3]) / (a[1] + (ncol(films) - 1) * a[3]), 1e-6)
    check(scenario, dimension, "icc_ck", "", (a[1] - a[3]) / a[1], 1e-6)
    if (ncol(films) <= 60) {
      icc <- psych::ICC(films, lmer = FALSE)$results
      check(scenario, dimension, "icc_c1", "", icc$ICC[3], 1e-6)
      check(scenario, dimension, "icc_ck", "", icc$ICC[6], 1e-6)
    }
  }
  if (all(dim(table) > 1)) {
    long <- data.frame(y = as.vector(table), who = factor(rep(seq_len(nrow(table)), ncol(table))), planner = factor(rep(shown, each = nrow(table))))
    f <- summary(aov(y ~ planner + Error(who), data = long))[["Error: Within"]][[1]][["F value"]][1]
    within <- anova(lm(y ~ planner + who, data = long))[["Mean Sq"]]
    if (within[2] > within[3]) check(scenario, dimension, "linear_f", "", f, 1e-6)
  }
  scores$y <- factor(round(scores$mean, 6), ordered = TRUE)
  scores$planner <- factor(scores$planner, levels = shown)
  scores$participant <- factor(scores$participant)
  full <- tryCatch(clmm(y ~ planner + (1 | participant), data = scores, nAGQ = 10, control = closely), error = function(e) NULL)
  none <- tryCatch(clmm(y ~ 1 + (1 | participant), data = scores, nAGQ = 10, control = closely), error = function(e) NULL)
  if (!is.null(full) && !is.null(none)) {
    deviation <- function(fit) sqrt(as.numeric(VarCorr(fit)[[1]]))
    by_planner <- model.matrix(~planner, scores)[, -1, drop = FALSE]
    of <- exactly(scores$y, by_planner, scores$participant, full$alpha, full$beta, deviation(full))
    without <- exactly(scores$y, by_planner[, 0, drop = FALSE], scores$participant, none$alpha, numeric(0), deviation(none))
    for (p in shown[-1]) {
      check(scenario, dimension, "clmm_effect", p, of$effects[[match(p, shown[-1])]], 1e-6)
      check(scenario, dimension, "clmm_error", p, of$errors[[match(p, shown[-1])]], 1e-6)
    }
    check(scenario, dimension, "clmm_sigma", "", of$sigma, if (of$sigma < 0.01) 1e-3 else 1e-6)
    check(scenario, dimension, "clmm_lr", "", 2 * (of$value - without$value), 1e-6)
  }
  if (is.null(full) || is.null(none)) cat("clmm finds no maximum for", scenario, dimension, "and is not compared\n")
  pairs <- combn(length(shown), 2)
  wins <- data.frame(
    first = factor(shown[pairs[1, ]], levels = shown), second = factor(shown[pairs[2, ]], levels = shown),
    a = apply(pairs, 2, function(p) sum(table[, p[1]] > table[, p[2]] + 1e-9)), b = apply(pairs, 2, function(p) sum(table[, p[2]] > table[, p[1]] + 1e-9)))
  fit <- tryCatch(BTm(cbind(a, b), first, second, data = wins, refcat = shown[1], br = FALSE), error = function(e) NULL, warning = function(w) NULL)
  if (!is.null(fit)) for (p in shown[-1]) check(scenario, dimension, "bradley_terry", p, unname(coef(fit)[paste0("..", p)]), 1e-5)
  if (any(ours$statistic == "davidson" & ours$scenario == scenario & ours$dimension == dimension)) {
    over <- sapply(shown, function(b) sapply(shown, function(a) sum(table[, a] > table[, b] + 1e-9)))
    strength <- davidson(over, nrow(table) - over - t(over))
    for (p in shown[-1]) check(scenario, dimension, "davidson", p, strength[[match(p, shown) - 1]], 1e-5)
    check(scenario, dimension, "davidson_ties", "", strength[[length(shown)]], 1e-5)
  }
}
cat(compared, "figures compared,", far, "differ\n")
quit(status = if (far > 0 || compared == 0) 1 else 0)
