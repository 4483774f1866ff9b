// Writes wall.ti with the library of the University of Bonn (README.md).
#include "TransientImage.h"

int main() {
    LibTransientImage::TransientImage image;
    const unsigned columns = 6, rows = 5, bins = 12;
    image.header.pixelMode = 10;
    image.header.numPixels = columns * rows;
    image.header.numBins = bins;
    image.header.tMin = 2.25f;
    image.header.tDelta = 0.5f;
    image.header.pixelInterpretationBlockSize = sizeof(image.pixelInterpretationBlock);
    image.data.resize(columns * rows * bins);
    auto& block = image.pixelInterpretationBlock;
    block.uResolution = columns;
    block.vResolution = rows;
    block.topLeft = {-1.5f, 2.0f, 0.0f};
    block.topRight = {1.5f, 2.0f, 0.0f};
    block.bottomLeft = {-1.5f, -0.5f, 0.0f};
    block.bottomRight = {1.5f, -0.5f, 0.0f};
    block.laserPosition = {0.0f, 0.75f, 0.0f};
    for (unsigned v = 0; v < rows; v++)
        for (unsigned u = 0; u < columns; u++)
            for (unsigned t = 0; t < bins; t++) image.AccessPixel(t, u, v) = 1.0f + t + 16.0f * u + 128.0f * v;
    image.imageProperties = "{ \"Name\": \"wall\" }";
    image.WriteFile("wall.ti");
}
