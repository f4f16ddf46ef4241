// What the reference drivers share: raw meshes, times, memory, and the one JSON object they print.
//
//   driver OPERATION INPUT [--repeat N] [--out FILE] [--scheme NAME] [--levels N] [--tags FILE]
//
// A raw mesh is what xtask writes so that every program starts from the same bits: three 64-bit
// counts (vertices, faces, corners), the coordinates as doubles, the start of each face and one end,
// and the vertex of each corner as 32-bit integers; all little-endian.
#pragma once

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

struct Raw {
    std::vector<std::array<double, 3>> points;
    std::vector<uint32_t> starts;
    std::vector<uint32_t> corners;

    std::size_t faces() const { return starts.empty() ? 0 : starts.size() - 1; }
    bool triangles() const {
        for (std::size_t f = 0; f < faces(); ++f)
            if (starts[f + 1] - starts[f] != 3) return false;
        return true;
    }
};

inline Raw read_raw(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error("cannot open " + path);
    uint64_t counts[3];
    in.read(reinterpret_cast<char*>(counts), sizeof counts);
    Raw raw;
    raw.points.resize(counts[0]);
    raw.starts.resize(counts[1] + 1);
    raw.corners.resize(counts[2]);
    in.read(reinterpret_cast<char*>(raw.points.data()), std::streamsize(counts[0] * 24));
    in.read(reinterpret_cast<char*>(raw.starts.data()), std::streamsize(raw.starts.size() * 4));
    in.read(reinterpret_cast<char*>(raw.corners.data()), std::streamsize(counts[2] * 4));
    if (!in) throw std::runtime_error("truncated: " + path);
    return raw;
}

inline void write_raw(const std::string& path, const Raw& raw) {
    std::ofstream out(path, std::ios::binary);
    const uint64_t counts[3] = {raw.points.size(), raw.faces(), raw.corners.size()};
    out.write(reinterpret_cast<const char*>(counts), sizeof counts);
    out.write(reinterpret_cast<const char*>(raw.points.data()), std::streamsize(raw.points.size() * 24));
    out.write(reinterpret_cast<const char*>(raw.starts.data()), std::streamsize(raw.starts.size() * 4));
    out.write(reinterpret_cast<const char*>(raw.corners.data()), std::streamsize(raw.corners.size() * 4));
}

// Resident memory now, in bytes.
inline double resident() {
    std::ifstream in("/proc/self/statm");
    long total = 0, resident = 0;
    in >> total >> resident;
    return double(resident) * double(sysconf(_SC_PAGESIZE));
}

// The most memory resident so far, in bytes. Not ru_maxrss, which a process inherits from its parent.
inline double most_resident() {
    std::ifstream in("/proc/self/status");
    for (std::string line; std::getline(in, line);)
        if (line.rfind("VmHWM:", 0) == 0) return std::stod(line.substr(6)) * 1024.0;
    return 0;
}

struct Clock {
    static double wall() {
        const auto now = std::chrono::steady_clock::now().time_since_epoch();
        return std::chrono::duration<double, std::milli>(now).count();
    }
    static double cpu() {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        const auto ms = [](const timeval& t) { return double(t.tv_sec) * 1e3 + double(t.tv_usec) / 1e3; };
        return ms(usage.ru_utime) + ms(usage.ru_stime);
    }
};

// The JSON object. Doubles print so that they read back bit for bit.
class Report {
public:
    void number(const std::string& key, double value) { add(key, digits(value)); }
    void truth(const std::string& key, bool value) { add(key, value ? "true" : "false"); }
    void text(const std::string& key, const std::string& value) { add(key, quoted(value)); }
    void list(const std::string& key, const std::vector<double>& values) {
        std::string joined;
        for (const double value : values) joined += (joined.empty() ? "" : ",") + digits(value);
        add(key, "[" + joined + "]");
    }

    // Runs `run` so often and notes wall and processor milliseconds of each run. What it returns is
    // destroyed outside the timed part.
    template <class Run>
    void time(int repeat, Run run) {
        time_from(repeat, [] { return 0; }, [&](int) { return run(); });
    }

    // The same for what changes its input, which `start` makes anew outside the timed part.
    template <class Start, class Run>
    void time_from(int repeat, Start start, Run run) {
        std::vector<double> wall, cpu;
        for (int i = 0; i < repeat; ++i) {
            auto&& state = start();
            const double w = Clock::wall(), c = Clock::cpu();
            const auto result = run(state);
            wall.push_back(Clock::wall() - w);
            cpu.push_back(Clock::cpu() - c);
        }
        list("ms", wall);
        list("cpu_ms", cpu);
    }

    void print() {
        number("peak_bytes", most_resident());
        std::cout << "{" << body << "}" << std::endl;
    }

private:
    static std::string digits(double value) {
        if (!std::isfinite(value)) return "null";
        char buffer[40];
        std::snprintf(buffer, sizeof buffer, "%.17g", value);
        return buffer;
    }
    static std::string quoted(const std::string& value) {
        std::string out = "\"";
        for (const char c : value) {
            if (c == '"' || c == '\\') out += '\\';
            out += (c == '\n') ? ' ' : c;
        }
        return out + "\"";
    }
    void add(const std::string& key, const std::string& value) {
        body += (body.empty() ? "" : ",") + quoted(key) + ":" + value;
    }
    std::string body;
};

// A column of doubles beside the report: `PREFIX.name.f64`.
inline void column(const std::string& prefix, const std::string& name, const std::vector<double>& values) {
    if (prefix.empty()) return;
    std::ofstream out(prefix + "." + name + ".f64", std::ios::binary);
    out.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * 8));
}

// Hash of all one-rings that depends neither on the order of the vertices nor on where a ring starts.
class RingHash {
public:
    void add(uint32_t center, std::vector<uint32_t> ring) {
        if (!ring.empty()) std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end()), ring.end());
        uint64_t hash = 14695981039346656037ULL;
        step(hash, center);
        for (const uint32_t v : ring) step(hash, v);
        sum += hash;
    }
    std::string hex() const {
        char buffer[20];
        std::snprintf(buffer, sizeof buffer, "%016llx", static_cast<unsigned long long>(sum));
        return buffer;
    }

private:
    static void step(uint64_t& hash, uint32_t value) {
        for (int shift = 0; shift < 32; shift += 8) {
            hash ^= (value >> shift) & 0xff;
            hash *= 1099511628211ULL;
        }
    }
    uint64_t sum = 0;
};

struct Call {
    std::string operation, input, out, scheme, tags;
    int repeat = 1, levels = 1;

    static Call parse(int count, char** arguments) {
        if (count < 3) throw std::runtime_error("usage: OPERATION INPUT [--repeat N] [--out FILE] …");
        Call call;
        call.operation = arguments[1];
        call.input = arguments[2];
        for (int i = 3; i + 1 < count; i += 2) {
            const std::string option = arguments[i];
            if (option == "--repeat") call.repeat = std::stoi(arguments[i + 1]);
            else if (option == "--out") call.out = arguments[i + 1];
            else if (option == "--scheme") call.scheme = arguments[i + 1];
            else if (option == "--levels") call.levels = std::stoi(arguments[i + 1]);
            else if (option == "--tags") call.tags = arguments[i + 1];
            else throw std::runtime_error("unknown option " + option);
        }
        return call;
    }
};

// Times `work` on copies of `original`, which are made outside the timed part; returns the last one, changed.
template <class Mesh, class Work>
std::unique_ptr<Mesh> time_on_copies(Report& report, int repeat, const Mesh& original, Work work) {
    std::unique_ptr<Mesh> last;
    report.time_from(
        repeat,
        [&] {
            last.reset();
            last = std::make_unique<Mesh>(original);
            return last.get();
        },
        [&](Mesh* mesh) {
            work(*mesh);
            return 0;
        });
    return last;
}

// What the process holds after building beyond what it held before, and the most it held between.
template <class Build>
void memory(Report& report, Build build) {
    std::ofstream("/proc/self/clear_refs") << 5;  // Forgets the most so far.
    const double before = resident();
    const auto mesh = build();
    report.number("mesh_bytes", resident() - before);
    report.number("build_peak_bytes", most_resident() - before);
}
