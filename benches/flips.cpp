// The job of flips.rs by Boost odeint: dopri5 with dense output, and the zeros by bisection.
// g++ -O3 -march=native flips.cpp -o flips && ./flips ROWS
#include <array>
#include <boost/numeric/odeint.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

using namespace boost::numeric::odeint;
using State = std::array<double, 3>;

struct Body {
    void operator()(const State &m, State &d, double) const {
        const double a = 1.0, b = 0.5, c = 1.0 / 3;
        d = {m[1] * m[2] * (c - b), m[2] * m[0] * (a - c), m[0] * m[1] * (b - a)};
    }
};

int main(int, char **arguments) {
    std::vector<State> exact;
    FILE *file = std::fopen(arguments[1], "r");
    for (State m; std::fscanf(file, "%lf %lf %lf", &m[0], &m[1], &m[2]) == 3;) exact.push_back(m);
    for (int digits = 6; digits < 15; ++digits) {
        const double tolerance = std::pow(10.0, -digits);
        double least = INFINITY, error = 0;
        std::size_t steps = 0, zeros = 0;
        for (int round = 0; round < 15; ++round) {
            const auto start = std::chrono::steady_clock::now();
            auto stepper = make_dense_output(tolerance, tolerance, runge_kutta_dopri5<State>());
            std::vector<State> rows{{0.1, 2.0, 0.3}};
            rows.reserve(exact.size());
            stepper.initialize(rows[0], 0.0, 0.01);
            double before = rows[0][1];
            State at;
            for (steps = zeros = 0; rows.size() < exact.size(); ++steps) {
                auto [from, to] = stepper.do_step(Body());
                const double after = stepper.current_state()[1];
                if ((before < 0) != (after < 0)) {
                    double low = from, high = to;
                    while (high - low > 1e-12) {
                        const double middle = 0.5 * (low + high);
                        stepper.calc_state(middle, at);
                        ((at[1] < 0) == (before < 0) ? low : high) = middle;
                    }
                    ++zeros;
                }
                before = after;
                for (; rows.size() < exact.size() && double(rows.size()) <= to; rows.push_back(at))
                    stepper.calc_state(double(rows.size()), at);
            }
            const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
            least = std::min(least, took.count());
            error = 0;
            for (std::size_t i = 0; i < rows.size(); ++i)
                error = std::max(error, std::hypot(rows[i][0] - exact[i][0], rows[i][1] - exact[i][1], rows[i][2] - exact[i][2]));
        }
        std::printf("%-20s 1e-%d %zu %zu %.2e %.3f\n", "odeint dopri5", digits, steps, zeros, error, least);
    }
}
