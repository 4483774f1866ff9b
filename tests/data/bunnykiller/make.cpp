// Writes streaks with the steps of BunnyKiller's film (README.md).
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include "stb_image_write.h"

#include <cstdio>
#include <vector>

const int columns = 6, rows = 4;

void streaks(const char* name, int bins) {
    for (int y = 0; y < rows; y++) {
        // Time along x, the columns of the camera along y.
        std::vector<float> slice(size_t(bins) * columns * 3);
        for (int x = 0; x < columns; x++)
            for (int t = 0; t < bins; t++)
                for (int c = 0; c < 3; c++) slice[(size_t(x) * bins + t) * 3 + c] = float((t + 1) * (x + 1) * (y + 1) * (c + 1)) / 4;
        int w = bins, h = columns;
        // Pictures of fewer than eight bins are stored transposed.
        if (w < 8) {
            std::vector<float> turned(slice.size());
            for (int i = 0; i < h; i++)
                for (int j = 0; j < w; j++)
                    for (int c = 0; c < 3; c++) turned[(size_t(j) * h + i) * 3 + c] = slice[(size_t(i) * w + j) * 3 + c];
            slice = turned;
            std::swap(w, h);
        }
        char file[256];
        std::snprintf(file, sizeof file, "%s_%04d.hdr", name, y);
        stbi_write_hdr(file, w, h, 3, slice.data());
        // Beside it, as with `-film-components`, its variance.
        if (bins >= 8) {
            std::snprintf(file, sizeof file, "%s_%04d_variance.hdr", name, y);
            for (float& value : slice) value = 0.5f;
            stbi_write_hdr(file, w, h, 3, slice.data());
        }
    }
    // The steady picture.
    std::vector<float> steady(columns * rows * 3, 2.0f);
    char file[256];
    std::snprintf(file, sizeof file, "%s.hdr", name);
    stbi_write_hdr(file, columns, rows, 3, steady.data());
}

int main() {
    streaks("streak", 10);
    streaks("short", 5);
}
