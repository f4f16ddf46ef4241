// CHOLMOD's supernodal Cholesky: order, factor and solve L + M, with as many threads as the environment
// gives to OpenBLAS and OpenMP.
//
//   cholmod amd|metis INPUT [--repeat N]
//
// L is the graph Laplacian of a raw mesh, M a thousandth of the identity. Prints milliseconds of
// wall time and of processors, those of each step, the entries of the factor, and the residual.
#include <cholmod.h>

#include "protocol.hpp"

extern "C" int openblas_get_num_threads();

// The lower triangle of L + M.
static cholmod_sparse* assemble(const Raw& raw, cholmod_common* common) {
    const int n = int(raw.points.size());
    std::vector<std::pair<int, int>> edges;
    for (std::size_t f = 0; f < raw.faces(); ++f)
        for (uint32_t c = raw.starts[f]; c < raw.starts[f + 1]; ++c) {
            const uint32_t next = c + 1 < raw.starts[f + 1] ? c + 1 : raw.starts[f];
            edges.emplace_back(std::minmax(int(raw.corners[c]), int(raw.corners[next])));
        }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    cholmod_triplet* t = cholmod_allocate_triplet(n, n, edges.size() + n, -1, CHOLMOD_REAL, common);
    auto rows = static_cast<int*>(t->i), columns = static_cast<int*>(t->j);
    auto values = static_cast<double*>(t->x);
    std::vector<double> diagonal(n, 1e-3);
    for (const auto& [a, b] : edges) {
        rows[t->nnz] = b, columns[t->nnz] = a, values[t->nnz] = -1;
        ++t->nnz;
        ++diagonal[a], ++diagonal[b];
    }
    for (int i = 0; i < n; ++i) {
        rows[t->nnz] = i, columns[t->nnz] = i, values[t->nnz] = diagonal[i];
        ++t->nnz;
    }
    cholmod_sparse* matrix = cholmod_triplet_to_sparse(t, t->nnz, common);
    cholmod_free_triplet(&t, common);
    return matrix;
}

int main(int count, char** arguments) try {
    const Call call = Call::parse(count, arguments);
    cholmod_common common;
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = call.operation == "metis" ? CHOLMOD_METIS : CHOLMOD_AMD;
    common.postorder = 1;
    cholmod_sparse* matrix = assemble(read_raw(call.input), &common);
    cholmod_dense* rhs = cholmod_allocate_dense(matrix->nrow, 1, matrix->nrow, CHOLMOD_REAL, &common);
    for (std::size_t i = 0; i < matrix->nrow; ++i) static_cast<double*>(rhs->x)[i] = std::sin(double(i));

    std::vector<double> order, factor, solve, total, wall;
    double entries = 0, residual = 0;
    for (int i = 0; i < call.repeat; ++i) {
        const double begun = Clock::wall(), start = Clock::cpu();
        cholmod_factor* symbolic = cholmod_analyze(matrix, &common);
        const double analyzed = Clock::cpu();
        cholmod_factorize(matrix, symbolic, &common);
        const double factored = Clock::cpu();
        cholmod_dense* x = cholmod_solve(CHOLMOD_A, symbolic, rhs, &common);
        const double solved = Clock::cpu();
        wall.push_back(Clock::wall() - begun);
        order.push_back(analyzed - start);
        factor.push_back(factored - analyzed);
        solve.push_back(solved - factored);
        total.push_back(solved - start);
        entries = common.lnz;
        cholmod_dense* rest = cholmod_copy_dense(rhs, &common);
        double one[2] = {1, 0}, minus[2] = {-1, 0};
        cholmod_sdmult(matrix, 0, minus, one, x, rest, &common);
        residual = cholmod_norm_dense(rest, 0, &common);
        cholmod_free_dense(&rest, &common);
        cholmod_free_dense(&x, &common);
        cholmod_free_factor(&symbolic, &common);
    }
    Report report;
    report.list("ms", wall);
    report.list("cpu_ms", total);
    report.list("order_cpu_ms", order);
    report.list("factor_cpu_ms", factor);
    report.list("solve_cpu_ms", solve);
    report.number("threads", openblas_get_num_threads());
    report.number("factor_entries", entries);
    report.number("residual", residual);
    report.print();
    return 0;
} catch (const std::exception& error) {
    std::cerr << error.what() << std::endl;
    return 1;
}
